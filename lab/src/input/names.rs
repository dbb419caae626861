//! Suggestions for a misspelt name.

/// Names that resemble the one asked for, or all if they are few: ` (did you mean ..?)`.
pub fn near<'a>(asked: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    const FEW: usize = 8;
    const MOST: usize = 3;
    let lower = asked.to_lowercase();
    let mut ranked: Vec<(f64, &str)> = names
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&lower, &name.to_lowercase()), name))
        .collect();
    if ranked.len() <= FEW {
        let names: Vec<&str> = ranked.iter().map(|(_, name)| *name).collect();
        return format!("there are {}", names.join(", "));
    }
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let names: Vec<&str> = ranked.iter().take(MOST).map(|(_, name)| *name).collect();
    format!("near it are {}; there are {}", names.join(", "), ranked.len())
}

#[cfg(test)]
mod tests {
    use super::near;

    #[test]
    fn few_names_are_all_told_and_many_by_likeness() {
        assert_eq!(near("gyro", ["gyro_x", "time"]), "there are gyro_x, time");
        let many = [
            "actuator_outputs",
            "battery",
            "cpuload",
            "ekf2",
            "gps",
            "home",
            "sensor_combined",
            "sensor_gyro",
            "vehicle",
        ];
        let told = near("sensor_combine", many);
        assert!(told.starts_with("near it are sensor_combined, sensor_gyro"), "{told}");
    }
}
