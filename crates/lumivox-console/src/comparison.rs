//! Reports on pictures and their references.

use lumivox_render::compare::ErrorFigures;
use serde::Serialize;

use crate::report::Table;

/// The errors of a comparison: of each share of a scene's light, or of two files (only `final`).
#[derive(Clone, Debug, Default, Serialize)]
pub struct Comparison {
    /// The scene's name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// The file of the reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    /// The file that is compared with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ours: Option<String>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Irradiance after one bounce.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub one_bounce: Option<ErrorFigures>,
    /// Irradiance after all bounces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full: Option<ErrorFigures>,
    /// The finished picture.
    #[serde(rename = "final", skip_serializing_if = "Option::is_none")]
    pub final_picture: Option<ErrorFigures>,
    /// Light that leaked into a dark room through its walls after one gather, in percent of the
    /// light in the next room.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leak_percent: Option<f64>,
    /// `leak_percent` after all bounces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leak_full_percent: Option<f64>,
}

impl Comparison {
    /// The report for people: a row for each picture, and an explanation of the columns.
    pub fn table(&self) -> String {
        let names = named_figures(&ErrorFigures::default()).map(|(name, _)| name);
        let mut table = Table::new(&[&[""], &names[..]].concat());
        for (label, figures) in
            [("one bounce", &self.one_bounce), ("full", &self.full), ("final", &self.final_picture)]
        {
            let Some(figures) = figures else { continue };
            let cells = named_figures(figures).map(|(_, value)| value.unwrap_or("-".to_owned()));
            let [bias, rmse, p95, flip, noise, with_noise] = cells;
            table.row([label.to_owned(), bias, rmse, p95, flip, noise, with_noise]);
        }
        let mut text = table.text();
        if let Some(leak) = self.leak_percent {
            text += &format!("\n  leak {leak:.2} % of the light in the lit room");
            if let Some(leak) = self.leak_full_percent {
                text += &format!(", {leak:.2} % after all bounces");
            }
            text.push('\n');
        }
        text + "\n  In % of the reference's mean; p95 (95 % of the pixels are no worse) in % of the pixel's own \
                luminance;\n  FLIP from 0 (equal) to 1. Noise is the reference's own; the RMSE excludes \
                it where it is known.\n"
    }
}

/// The figures for people, in the order of the columns; `None` where one is unknown.
pub fn named_figures(figures: &ErrorFigures) -> [(&'static str, Option<String>); 6] {
    let percent = |value: f64| format!("{value:.2} %");
    [
        ("bias", Some(format!("{:+.2} %", figures.bias_percent))),
        ("RMSE", Some(percent(figures.rmse_percent))),
        ("p95", Some(percent(figures.p95_percent))),
        ("FLIP", figures.flip.map(|flip| format!("{flip:.4}"))),
        ("noise", figures.noise_percent.map(percent)),
        ("RMSE with it", Some(percent(figures.rmse_with_noise_percent))),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures() -> ErrorFigures {
        ErrorFigures {
            bias_percent: 2.104,
            rmse_percent: 12.0,
            rmse_with_noise_percent: 12.5,
            p95_percent: 7.5,
            flip: Some(0.031_25),
            ..ErrorFigures::default()
        }
    }

    #[test]
    fn the_table_has_only_rows_with_figures() {
        let full = ErrorFigures { noise_percent: Some(0.5), ..figures() };
        let comparison = Comparison {
            full: Some(full),
            final_picture: Some(figures()),
            leak_percent: Some(0.4),
            ..Comparison::default()
        };
        let text = comparison.table();
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split_whitespace().collect()).collect();
        assert_eq!(lines[0], ["bias", "RMSE", "p95", "FLIP", "noise", "RMSE", "with", "it"]);
        let shared = ["+2.10", "%", "12.00", "%", "7.50", "%", "0.0312"];
        assert_eq!(lines[1], [&["full"], &shared[..], &["0.50", "%", "12.50", "%"]].concat());
        assert_eq!(lines[2], [&["final"], &shared[..], &["-", "12.50", "%"]].concat());
        assert!(text.contains("leak 0.40 %"), "{text}");
    }

    #[test]
    fn json_omits_comparisons_that_were_not_made() {
        let comparison = Comparison {
            scene: Some("cornell".to_owned()),
            size: [4, 3],
            final_picture: Some(figures()),
            ..Comparison::default()
        };
        let json = serde_json::to_value(&comparison).unwrap();
        assert_eq!(json["final"]["rmse_percent"], 12.0);
        assert!(json["final"]["noise_percent"].is_null());
        assert_eq!(json["size"], serde_json::json!([4, 3]));
        let keys: Vec<&String> = json.as_object().unwrap().keys().collect();
        assert_eq!(keys, ["final", "scene", "size"]);
    }
}
