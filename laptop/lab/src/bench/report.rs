//! Compares the figures measured here with the figures in the paper's tables.

use super::CaseResult;
use super::paper::{EFFICIENCY, MISPRINT, RMSE, SCHEMES, TESTS, Table};
use super::statistics::Statistics;
use serde::Serialize;
use serde_json::{Value, json as object};
use std::fmt::Write;

/// Tolerance for the difference between a measured mean and the paper's mean, in standard errors.
const STANDARD_ERRORS: f64 = 4.0;
/// Tolerance for the difference between a measured standard deviation and the paper's, as a share of the paper's
/// standard deviation.
const DEVIATION_PART: f64 = 0.15;

/// A measured cell, and the paper's figures for it.
#[derive(Clone, Copy, Debug, Serialize)]
struct Cell {
    ours: Statistics,
    paper_mean: f64,
    paper_deviation: f64,
    /// Difference between the measured mean and the paper's mean, as a multiple of the standard error of the
    /// difference. The paper's rounding error is subtracted from the difference beforehand.
    standard_errors: f64,
    mean_agrees: bool,
    deviation_agrees: bool,
    /// Whether `paper_deviation` is the figure that the paper misprints.
    is_misprint: bool,
}

impl Cell {
    fn new(table: &Table, case: usize, scheme: usize, ours: Statistics) -> Self {
        let (mean, deviation) = (table.means[case][scheme], table.deviations[case][scheme]);
        let error = ours.error_against(TESTS);
        let off = ours.mean - mean;
        let beyond = (off.abs() - table.rounding()).max(0.0).copysign(off);
        // With few tests the deviation itself is uncertain, by a share of 1 / √(2 (N - 1)).
        let few = STANDARD_ERRORS / (2.0 * (ours.count as f64 - 1.0)).sqrt();
        let part = if ours.count < TESTS { DEVIATION_PART.max(few) } else { DEVIATION_PART };
        Self {
            ours,
            paper_mean: mean,
            paper_deviation: deviation,
            // Adding 0 turns -0 into 0.
            standard_errors: beyond / error + 0.0,
            mean_agrees: beyond.abs() <= STANDARD_ERRORS * error,
            deviation_agrees: (ours.deviation - deviation).abs()
                <= part * deviation + table.rounding(),
            is_misprint: table.title == RMSE.title && (case, scheme) == MISPRINT,
        }
    }
}

/// Compares each measured cell of a table with the paper's. The result is indexed by case and then by scheme.
fn cells(table: &Table, cases: &[CaseResult]) -> Vec<Vec<Cell>> {
    let is_rmse = table.title == RMSE.title;
    let of = |case: &CaseResult| if is_rmse { case.rmse } else { case.efficiency };
    let row = |(index, case)| {
        let ours = of(case);
        (0..SCHEMES.len()).map(|scheme| Cell::new(table, index, scheme, ours[scheme])).collect()
    };
    cases.iter().enumerate().map(row).collect()
}

/// Formats both tables as Markdown, followed by the number of cells that agree with the paper.
pub fn print(cases: &[CaseResult]) -> String {
    let mut text = String::new();
    let mut all = Vec::new();
    for table in [&EFFICIENCY, &RMSE] {
        let cells = cells(table, cases);
        // Writing to a string cannot fail.
        let _ = write_table(&mut text, table, cases, &cells);
        all.extend(cells.into_iter().flatten());
    }
    let total = all.len();
    let deviations = all.iter().filter(|cell| cell.deviation_agrees).count();
    let means = all.iter().filter(|cell| cell.mean_agrees).count();
    let _ = write!(
        text,
        "{deviations} of {total} standard deviations within 15 % and the paper's rounding"
    );
    if let Some(cell) = all.iter().find(|cell| cell.is_misprint && !cell.deviation_agrees) {
        let _ = write!(
            text,
            "; T-HSA at 15 s is a slip of the paper: it prints {:.2}, the toolbox's own record says 0.0059, here it is {:.4}",
            cell.paper_deviation, cell.ours.deviation
        );
    }
    let (unseen, scheme) = unseen(cases);
    let tests = cases.first().map_or(0, |case| case.rmse[0].count);
    let _ = writeln!(
        text,
        "\nWith {tests} signals a case, a mean may be off by {:.1} % ({scheme}) and still pass",
        100.0 * unseen
    );
    let _ = writeln!(text, "{means} of {total} means within sampling error");
    text
}

/// Finds the cell with the largest tolerance. The tolerance of a cell is the largest difference from the paper's mean
/// that counts as agreement. Returns the tolerance as a share of the paper's mean, and the name of the cell.
fn unseen(cases: &[CaseResult]) -> (f64, String) {
    let all = [&EFFICIENCY, &RMSE].into_iter().flat_map(|table| {
        cells(table, cases).into_iter().zip(cases).flat_map(|(row, case)| {
            row.into_iter().zip(SCHEMES).map(|(cell, scheme)| {
                let error = STANDARD_ERRORS * cell.ours.error_against(TESTS);
                (error / cell.paper_mean.abs(), format!("{scheme} at {} s", case.seconds))
            })
        })
    });
    all.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
}

/// Lists the measured means and standard deviations that disagree with the paper's tables. Leaves out the standard
/// deviation that the paper misprints.
pub fn differing(cases: &[CaseResult]) -> Vec<String> {
    let mut names = Vec::new();
    for (table, quantity) in [(&EFFICIENCY, "efficiency"), (&RMSE, "RMSE")] {
        for (row, case) in cells(table, cases).iter().zip(cases) {
            for (cell, scheme) in row.iter().zip(SCHEMES) {
                let wrong = [
                    (!cell.mean_agrees, "mean"),
                    (!cell.deviation_agrees && !cell.is_misprint, "deviation"),
                ];
                for (_, figure) in wrong.into_iter().filter(|(is_wrong, _)| *is_wrong) {
                    names.push(format!(
                        "{scheme} at {} s, {figure} of the {quantity}",
                        case.seconds
                    ));
                }
            }
        }
    }
    names
}

/// A function that returns one figure of a cell, such as its mean: first as measured, then as printed in the paper.
type Figures = fn(&Cell) -> [f64; 2];
/// A function that returns one measured figure, for a column that the paper does not have.
type Figure = fn(&Statistics) -> f64;

fn write_table(
    text: &mut String,
    table: &Table,
    cases: &[CaseResult],
    cells: &[Vec<Cell>],
) -> std::fmt::Result {
    let decimals = table.decimals;
    let ours_decimals = decimals + 1;
    writeln!(
        text,
        "{}: ours / the paper's (difference beyond its rounding, in standard errors)\n",
        table.title
    )?;
    write!(text, "| {:9} |", "")?;
    SCHEMES.iter().try_for_each(|scheme| write!(text, " {scheme:21} |"))?;
    writeln!(text, " {:12} | {:12} |", "GRF", "GRF, slots")?;
    writeln!(
        text,
        "|{:-<11}|{}{:-<14}|{:-<14}|",
        "",
        format!("{:-<23}|", "").repeat(SCHEMES.len()),
        "",
        ""
    )?;
    for (case, row) in cases.iter().zip(cells) {
        let ours = if table.title == RMSE.title { &case.rmse } else { &case.efficiency };
        let rows: [(&str, Figures, Figure); 2] = [
            ("mean", |cell| [cell.ours.mean, cell.paper_mean], |ours| ours.mean),
            ("SD", |cell| [cell.ours.deviation, cell.paper_deviation], |ours| ours.deviation),
        ];
        for (name, figures, extra) in rows {
            let label =
                if name == "mean" { format!("{} s mean", case.seconds) } else { name.to_owned() };
            write!(text, "| {label:>9} |")?;
            for cell in row {
                let agrees = if name == "mean" { cell.mean_agrees } else { cell.deviation_agrees };
                let mark = if agrees { "" } else { " !" };
                let [value, paper] = figures(cell);
                let shown = format!("{value:.ours_decimals$} / {paper:.decimals$}");
                let errors = if name == "mean" {
                    format!(" ({:+.1})", cell.standard_errors)
                } else {
                    String::new()
                };
                write!(text, " {:21} |", format!("{shown}{errors}{mark}"))?;
            }
            for ours in &ours[SCHEMES.len()..] {
                write!(text, " {:12} |", format!("{:.ours_decimals$}", extra(ours)))?;
            }
            writeln!(text)?;
        }
    }
    writeln!(text)
}

/// Returns the cells of Tables I and II as JSON. Each cell has the measured figures and the paper's.
pub fn json(cases: &[CaseResult], seed: u64) -> Value {
    let table = |table: &Table| -> Value {
        let cells = cells(table, cases);
        let rows = cases.iter().zip(cells).map(|(case, row)| {
            let ours = if table.title == RMSE.title { &case.rmse } else { &case.efficiency };
            let mut schemes: serde_json::Map<String, Value> = SCHEMES
                .iter()
                .zip(row)
                .map(|(scheme, cell)| ((*scheme).to_owned(), object!(cell)))
                .collect();
            for (name, ours) in ["GRF", "GRF, slots"].iter().zip(&ours[SCHEMES.len()..]) {
                schemes.insert((*name).to_owned(), object!({ "ours": ours }));
            }
            object!({ "seconds": case.seconds, "schemes": schemes })
        });
        rows.collect()
    };
    let all: Vec<Cell> =
        [&EFFICIENCY, &RMSE].iter().flat_map(|table| cells(table, cases)).flatten().collect();
    object!({
        "seed": seed,
        "efficiency": table(&EFFICIENCY),
        "rmse": table(&RMSE),
        "cells": all.len(),
        "means_within_sampling_error": all.iter().filter(|cell| cell.mean_agrees).count(),
        "deviations_within_15_percent": all.iter().filter(|cell| cell.deviation_agrees).count(),
    })
}
