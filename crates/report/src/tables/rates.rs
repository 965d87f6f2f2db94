//! Table of a scene's rates for a terminal.
use stochc_ir::{Cell, Face};
use stochc_results::{EnsembleProgram, Manifest};
use stochc_runtime::Model;
use stochc_runtime::rates::{GUESS_ERROR, MAX_HELD_OUT_ERROR, Neighbourhood, Parameters, Rates};
use stochc_text::visible;
use stochc_text::{number, percent};

use super::comparison::ticks;
use stochc_text::{TextColumn, TextTable};

/// Note about the accuracy of the rate model.
pub const KNOWN_BIAS: &str = "Times are estimates of the rate model. In the default scene, its means differed from simulations by 3 % on \
     average and by at most 13 % (26 programs). In other scenes they differed by up to 20 % (docs/validation/rates.md).";

/// Returns a sentence for each program whose times in the rate model are lower bounds.
pub fn lower_bounds(manifest: &Manifest) -> Vec<String> {
    let known = |program: &EnsembleProgram| {
        let settings = manifest.settings_of(program);
        let is_by_rates = settings.model == Model::Rate;
        let rates = Rates::known(&settings.rates, &program.scene).filter(|_| is_by_rates)?;
        let reasons = program.lower_bound(rates);
        (!reasons.is_empty()).then(|| {
            let name = visible(&program.name);
            format!("The times of {name} are lower bounds: {}.", reasons.text())
        })
    };
    manifest.programs.iter().filter_map(known).collect()
}

/// Returns the note about uncalibrated estimates.
pub fn first_guess() -> String {
    let (usual, most) = GUESS_ERROR;
    format!(
        "The scene has no calibrated rates, so these are uncalibrated estimates from kinetic theory. In \
         calibrated scenes, such mean waiting times were wrong by a factor of {usual} (root mean square), and of {most} \
         at most (docs/validation/rates.md). Measure the rates with \
         `stochc calibrate FILE --out X.rates`, and pass them with `--rates X.rates`."
    )
}

/// Returns the parameters of the rate law with their standard errors, and the rates of example
/// faces. `width` is the width of the terminal \[characters\].
pub fn rates_to_text(rates: &Rates, width: usize) -> String {
    let mut text = format!(
        "{} captures by {}, seed {}\n\n",
        rates.captures, rates.simulated, rates.seed
    );
    text += &numbers(rates).text(width, false);
    if let Some(held_out) = &rates.held_out {
        text += &format!(
            "\nheld-out error of mean waiting times: {} (sampling error {}); commands accept at most {}\n",
            percent(held_out.error),
            percent(held_out.sampling),
            percent(MAX_HELD_OUT_ERROR)
        );
    }
    text += &format!("\n{}", examples(rates).text(width, false));
    if !rates.head_starts.is_empty() {
        text += &format!("\n{}", head_starts(rates).text(width, false));
    }
    text
}

fn numbers(rates: &Rates) -> TextTable {
    let rows = 0..Parameters::COUNT;
    let error = |i: usize| {
        rates.covariance[i * (Parameters::COUNT + 1)]
            .max(0.0)
            .sqrt()
    };
    let values = rows
        .clone()
        .map(|i| format!("{:.3}", rates.parameters.0[i]));
    let errors = rows.map(|i| format!("{:.3}", error(i)));
    let meanings = Parameters::ALL.iter().map(|it| it.meaning.to_owned());
    TextTable {
        label: "number".to_owned(),
        labels: Parameters::ALL
            .iter()
            .map(|it| it.name.to_owned())
            .collect(),
        columns: vec![
            TextColumn::figures("value", values.collect()),
            TextColumn::figures("standard error", errors.collect()),
            TextColumn::words("", meanings.collect()),
        ],
        ..TextTable::default()
    }
}

/// Returns a table of rates in simple surroundings: some occupied cells, and an open cell above or
/// next to them.
fn examples(rates: &Rates) -> TextTable {
    let at = |x, z| Cell::new(x, 0, z);
    let tower = |x: i32, top: i32| move |cell: Cell| (cell.x, cell.y) == (x, 0) && cell.z <= top;
    type IsFull = Box<dyn Fn(Cell) -> bool>;
    let rows: [(&str, Cell, Face, IsFull); 5] = [
        (
            "a face of the plate",
            at(0, 1),
            Face::Up,
            Box::new(|_| false),
        ),
        (
            "the top of a tower of 4",
            at(0, 5),
            Face::Up,
            Box::new(tower(0, 4)),
        ),
        (
            "its side at the top",
            at(1, 4),
            Face::East,
            Box::new(tower(0, 4)),
        ),
        (
            "the top of a tower of 2 next to one of 4",
            at(0, 3),
            Face::Up,
            { Box::new(move |cell| tower(0, 2)(cell) || tower(1, 4)(cell)) },
        ),
        (
            "the top of a tower of 2 between two of 4",
            at(0, 3),
            Face::Up,
            { Box::new(move |cell| tower(0, 2)(cell) || tower(1, 4)(cell) || tower(-1, 4)(cell)) },
        ),
    ];
    let waits: Vec<(f64, f64)> = (rows.iter())
        .map(|(_, cell, direction, is_full)| {
            let seen = rates.surroundings(
                *cell,
                *direction,
                Neighbourhood::new(*cell, is_full),
                |_| None,
            );
            let (mean, variance) = rates.wait(&seen).moments();
            (mean, variance.max(0.0).sqrt())
        })
        .collect();
    TextTable {
        label: "waiting time at an open face".to_owned(),
        labels: rows.iter().map(|(name, ..)| (*name).to_owned()).collect(),
        columns: vec![
            TextColumn::figures("mean ticks", waits.iter().map(|it| ticks(it.0)).collect()),
            TextColumn::figures("SD", waits.iter().map(|it| ticks(it.1)).collect()),
        ],
        ..TextTable::default()
    }
}

fn head_starts(rates: &Rates) -> TextTable {
    let all = &rates.head_starts;
    let places = all.iter().map(|it| {
        let distance = number(f64::from(it.squared_distance).sqrt());
        match it.before {
            0 if it.late => format!("{distance}, opening a moment later"),
            0 => distance,
            before if before > 0 => format!("{distance}, {before} before it"),
            before => format!("{distance}, {} after it", -before),
        }
    });
    TextTable {
        label: "distance of the release from an open cell".to_owned(),
        labels: places.collect(),
        columns: vec![
            TextColumn::figures(
                "docks there",
                all.iter().map(|it| percent(it.probability)).collect(),
            ),
            TextColumn::figures("in ticks", all.iter().map(|it| ticks(it.ticks)).collect()),
        ],
        ..TextTable::default()
    }
}
