//! Do the numbered rules of the language hold? Each sentence of each rule is a test that is named after it.
//!
//! What a test expects follows from the reference by hand; flows are polynomials where only events matter.

mod rule_01_links;
mod rule_01_choice;
mod rule_01_state;
mod rule_02_arming;
mod rule_03_instant;
mod rule_04_micro_steps;
mod rule_04_hierarchy;
mod rule_04_regions;
mod rule_05_writing;
mod rule_06_start;
mod rule_07_reset;
mod rule_08_claims;
mod rule_09_events;
mod rule_10_lives;
mod rule_10_crowds;
mod rule_10_named_sets;
mod rule_11_time;
mod rule_11_rate;
mod rule_11_pairs;
mod rule_12_end;
mod rule_13_coupling;
mod rule_13_sets;
mod rule_14_wakes;
mod rule_15_kinks;
mod rule_16_output;
