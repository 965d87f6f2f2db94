//! Tests that docs/reference/executable.md lists every word in event tables, as each format writes
//! it.
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use stochc::ir::emit::{table_json, table_text};
use stochc::ir::scene::BondKind;
use stochc::ir::table::{
    Action, Condition, Notification, Phase, PhaseId, Plate, Role, RoleId, Tables, Trigger,
};
use stochc::ir::{Cell, Face};

const PAGE: &str = include_str!("../../docs/reference/executable.md");

const A: RoleId = RoleId(1);
const B: RoleId = RoleId(2);
const CELL: Cell = Cell { x: 1, y: 1, z: 1 };

/// Returns the names of the variants of an enumeration in a file. Serde lists them when it reads an
/// unknown name.
fn words<T: DeserializeOwned>() -> Vec<String> {
    let error = serde_json::from_value::<T>(json!("no such word"));
    let error = error.err().expect("no such item").to_string();
    let expected = error.split_once("expected").expect("the output").1;
    let words = expected.split('`').skip(1).step_by(2);
    words.map(str::to_owned).collect()
}

/// Returns the word of a value in JSON: the value itself, or its only key.
fn word(value: &Value) -> &str {
    let key = value.as_object().and_then(|it| it.keys().next());
    key.map(String::as_str)
        .or(value.as_str())
        .expect("a word, alone or with something")
}

/// Returns tables with one rule to show. Its seed `M` captures `A`.
fn tables(bond: BondKind, trigger: Trigger, when: Vec<Condition>, then: Action) -> Tables {
    let phase = Phase {
        name: "grow".to_owned(),
        timeout: None,
        wait: 0,
        reports: 0,
        recovery: None,
        pre_attached: false,
    };
    let role = |name: &str| Role {
        name: name.to_owned(),
        seed: None,
    };
    let first = Action::Magnetize {
        face: Face::East,
        child: A,
        cell: CELL,
    };
    let rules = vec![(Vec::new(), first), (when, then)];
    let duties = vec![(RoleId(0), PhaseId(0), trigger, rules)];
    let plate = Plate { width: 3, depth: 3 };
    let roles = vec![role("M"), role("A"), role("B")];
    let mut tables = Tables::assemble("a", 1, plate, vec![phase], roles, duties);
    tables.bond = bond;
    tables
}

/// Returns the duty of these tables in the output of `--json`, and its lines in the text output.
fn shown(tables: &Tables) -> (Value, Vec<String>) {
    let json = serde_json::to_value(table_json(tables)).expect("JSON");
    let text = table_text(tables).to_string();
    let lines = text.lines().skip_while(|line| !line.starts_with("block "));
    let lines = lines.skip(1).map(|line| line.trim().to_owned());
    (json["blocks"][0]["duties"][0].clone(), lines.collect())
}

fn trigger_rows() -> Vec<(Value, String)> {
    let all = [Trigger::Start, Trigger::Anchored].into_iter();
    let row = |trigger| {
        let tables = tables(BondKind::Attract, trigger, Vec::new(), Action::Report);
        let (json, lines) = shown(&tables);
        (json!(trigger), row(&trigger, &json["trigger"], &lines[0]))
    };
    all.map(row).collect()
}

fn condition_rows() -> Vec<(Value, String)> {
    let all = [
        Condition::Docked(A),
        Condition::Asked(A),
        Condition::Released(A),
        Condition::Notified(Notification::Anchored(B)),
        Condition::Notified(Notification::Released(B)),
        Condition::Turn(1),
    ];
    let row = |condition| {
        let tables = tables(
            BondKind::Attract,
            Trigger::Start,
            vec![condition],
            Action::Report,
        );
        let (json, lines) = shown(&tables);
        let json = &json["rules"][1]["when"][0];
        let sentence = lines[2].split(':').next().expect("a condition");
        (json!(condition), row(&condition, json, sentence))
    };
    all.into_iter().map(row).collect()
}

fn action_rows() -> Vec<(Value, String)> {
    let magnetize = Action::Magnetize {
        face: Face::Up,
        child: A,
        cell: CELL,
    };
    let switch_off = Action::SwitchOff {
        face: Face::Up,
        child: A,
    };
    let notification = Notification::Anchored(A);
    let of_bonds = [BondKind::Attract, BondKind::Suction, BondKind::Reject];
    let with_hardware = |action| of_bonds.map(|bond| (bond, action));
    let mut all = Vec::from(with_hardware(magnetize));
    all.extend(with_hardware(switch_off));
    let messages = [
        Action::AskRelease,
        Action::AskReleaseLater(20),
        Action::Notify {
            to: B,
            notification,
        },
        Action::Report,
    ];
    all.extend(messages.map(|action| (BondKind::Attract, action)));
    let row = |(bond, action)| {
        let (json, lines) = shown(&tables(bond, Trigger::Start, Vec::new(), action));
        let json = &json["rules"][1]["then"];
        (json!(action), row(&action, json, &lines[2]))
    };
    all.into_iter().map(row).collect()
}

/// Returns the first cells of a row on the page: the word in executables, in `--json`, and in text.
fn row(word: &impl Serialize, json: &Value, text: &str) -> String {
    // The order of the fields in the file is their order here.
    let file = serde_json::to_string(word).expect("JSON");
    format!("| `{file}` | `{json}` | `{text}` | ")
}

#[track_caller]
fn assert_rows(words: &[String], rows: Vec<(Value, String)>) {
    let without: Vec<_> = (words.iter())
        .filter(|&it| !rows.iter().any(|(value, _)| word(value) == it))
        .collect();
    assert!(without.is_empty(), "no row here for {without:?}");
    for (_, row) in rows {
        let found = PAGE.lines().find_map(|line| line.strip_prefix(&*row));
        let meaning =
            found.unwrap_or_else(|| panic!("docs/reference/executable.md has no row\n{row}"));
        assert!(
            meaning.len() > 10,
            "docs/reference/executable.md says nothing of\n{row}"
        );
    }
}

#[test]
fn every_trigger_condition_and_action_is_documented() {
    assert_rows(&words::<Trigger>(), trigger_rows());
    assert_rows(&words::<Condition>(), condition_rows());
    assert_rows(&words::<Action>(), action_rows());
    let notified = condition_rows().into_iter();
    let notified = notified.filter(|(value, _)| word(value) == "notified");
    let notifications = notified.map(|(value, row)| (value["notified"].clone(), row));
    assert_rows(&words::<Notification>(), notifications.collect());
}
