//! prof
#![allow(missing_docs)]
pub static T: [std::sync::atomic::AtomicU64; 32] = [const { std::sync::atomic::AtomicU64::new(0) }; 32];
pub static C: [std::sync::atomic::AtomicU64; 32] = [const { std::sync::atomic::AtomicU64::new(0) }; 32];
pub struct G(usize, u64);
pub fn now() -> u64 { unsafe { std::arch::x86_64::_rdtsc() } }
pub fn g(k: usize) -> G { G(k, now()) }
impl Drop for G { fn drop(&mut self) { let d = now() - self.1; T[self.0].fetch_add(d, std::sync::atomic::Ordering::Relaxed); C[self.0].fetch_add(1, std::sync::atomic::Ordering::Relaxed); } }
pub fn show(names: &[&str]) { for (k, n) in names.iter().enumerate() { let c = C[k].load(std::sync::atomic::Ordering::Relaxed); let t = T[k].load(std::sync::atomic::Ordering::Relaxed); eprintln!("{n:20} {c:10} calls {:10.2} ms {:8.0} ns/call", t as f64 / 2.0e6, t as f64 / 2.0 / c as f64); } }
pub fn add(k: usize, n: u64) { C[k].fetch_add(n, std::sync::atomic::Ordering::Relaxed); }
