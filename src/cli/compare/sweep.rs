//! What is run: every value of the swept parameter, every seed, every tolerance.

use super::super::Refused;

/// A parameter with its values: one, or many (`N=2:20`, `N=2:20:3`).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Swept {
    pub(super) name: String,
    pub(super) values: Vec<String>,
}

/// Parameters with their values.
type Params = Vec<(String, String)>;

/// One setting of all parameters, the seed and the tolerance.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cell {
    /// Every parameter that is given.
    pub(super) params: Params,
    /// Those that have several values.
    pub(super) label: String,
    pub(super) seed: Option<u64>,
}

/// A parameter as the user gives it; what is no range of numbers is a value.
pub(super) fn swept(name: &str, value: &str) -> Result<Swept, Refused> {
    let parts: Vec<&str> = value.split(':').collect();
    let numbers: Option<Vec<f64>> = parts.iter().map(|part| part.trim().parse().ok()).collect();
    let values = match numbers.as_deref() {
        Some(&[from, to]) => range(from, to, 1.0),
        Some(&[from, to, step]) => range(from, to, step),
        Some(_) | None => return Ok(Swept { name: name.into(), values: vec![value.into()] }),
    };
    if values.is_empty() || values.len() > VALUES_MAX {
        return Err(format!("`{name}={value}` has {} values; write FROM:TO or FROM:TO:STEP", values.len()));
    }
    Ok(Swept { name: name.into(), values })
}

/// More values of one parameter are a mistake.
const VALUES_MAX: usize = 10_000;

fn range(from: f64, to: f64, step: f64) -> Vec<String> {
    let n = (to - from) / step;
    if !(n >= 0.0 && n <= VALUES_MAX as f64) {
        return Vec::new();
    }
    (0..=(n * (1.0 + 1e-12)).floor() as u64).map(|k| (from + k as f64 * step).to_string()).collect()
}

/// All combinations, the seeds of one setting together. Without seeds, that of the model.
pub(super) fn cells(swept: &[Swept], seeds: Option<u64>) -> Vec<Cell> {
    let mut settings: Vec<(Params, Vec<String>)> = vec![Default::default()];
    for parameter in swept {
        let many = parameter.values.len() > 1;
        settings = (settings.iter())
            .flat_map(|(params, labels)| {
                parameter.values.iter().map(move |value| {
                    let (mut params, mut labels) = (params.clone(), labels.clone());
                    params.push((parameter.name.clone(), value.clone()));
                    labels.extend(many.then(|| format!("{}={value}", parameter.name)));
                    (params, labels)
                })
            })
            .collect();
    }
    let seeds: Vec<Option<u64>> = seeds.map_or(vec![None], |n| (1..=n).map(Some).collect());
    let with_seeds = settings.into_iter().flat_map(|(params, labels)| {
        let label = labels.join(" ");
        seeds
            .iter()
            .map(move |&seed| Cell { params: params.clone(), label: label.clone(), seed })
            .collect::<Vec<_>>()
    });
    with_seeds.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_both_its_ends() {
        assert_eq!(swept("N", "2:5").unwrap().values, ["2", "3", "4", "5"]);
        assert_eq!(swept("x", "0:0.3:0.1").unwrap().values.len(), 4);
        assert_eq!(swept("data", "a:b").unwrap().values, ["a:b"]);
        assert_eq!(swept("N", "7").unwrap().values, ["7"]);
        assert!(swept("N", "5:2").is_err());
        assert!(swept("N", "1:2:0").is_err());
    }

    #[test]
    fn every_combination_is_there_once() {
        let swept = [swept("N", "2:3").unwrap(), swept("R", "1").unwrap()];
        let cells = cells(&swept, Some(2));
        let found: Vec<_> = cells.iter().map(|cell| (cell.label.as_str(), cell.seed)).collect();
        assert_eq!(found, [("N=2", Some(1)), ("N=2", Some(2)), ("N=3", Some(1)), ("N=3", Some(2))]);
    }
}
