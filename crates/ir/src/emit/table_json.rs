//! Event tables as JSON.
use serde_json::{Value, json};

use crate::Json;
use crate::scene::BondKind;
use crate::table::{Action, Condition, Duty, Notification, RoleId, Tables, Trigger};

/// Returns event tables with names.
///
/// `{ assembly, faces, plate: { width, depth }, phases: [{ name, reports, timeout }], blocks: [{
/// name, seed, duties: [{ phase, trigger, rules: [{ when, then }] }] }] }`. A cell is `[x, y, z]`,
/// and a timeout is in ticks. A condition is `{ docked: NAME }`, `{ asked: NAME }`, `{ released:
/// NAME }`, `{ notified: { anchored: NAME } }`, or `{ turn: { enough: n, of: [NAME] } }`: n of these
/// have docked.
///
/// The verbs for capture and release depend on the kind of bond: `magnetize` and `switch_off`,
/// `open` and `close`, or `expect` and `reject`. The field `bond` names the kind unless it is
/// `attract`. If every face always attracts, `otherwise` gives the action for a block at a face
/// that expects none.
pub fn table_json(tables: &Tables) -> Json<'_> {
    let blocks = move || {
        let roles = tables.roles.iter().enumerate();
        roles.map(move |(i, role)| {
            let role_id = RoleId(i as u32);
            let duties = move || tables.duties_of(role_id).map(move |it| duty(tables, it));
            Json::object([
                ("name", role.name.as_str().into()),
                ("seed", json!(role.seed).into()),
                ("duties", Json::list(duties)),
            ])
        })
    };
    let mut fields = vec![
        ("assembly", tables.assembly.as_str().into()),
        ("faces", tables.faces.into()),
        ("plate", json!(tables.plate).into()),
        (
            "phases",
            Json::each(&tables.phases, |phase| json!(phase).into()),
        ),
        ("blocks", Json::list(blocks)),
    ];
    if tables.bond != BondKind::default() {
        fields.push(("bond", json!(tables.bond).into()));
    }
    if let Some(size) = tables.aggregate {
        fields.push(("aggregate", size.into()));
    } else if tables.bond.is_passive() {
        let otherwise = json!({ "do": "reject", "face": "any other" });
        fields.push(("otherwise", otherwise.into()));
    }
    Json::object(fields)
}

fn duty<'a>(tables: &'a Tables, duty: Duty<'a>) -> Json<'a> {
    let rules = move || {
        duty.rules().enumerate().map(move |(index, rule)| {
            let when = move |&when: &Condition| condition(tables, duty, index, when).into();
            let when = Json::each(rule.when, when);
            Json::object([("when", when), ("then", action(tables, rule.then).into())])
        })
    };
    let trigger = match duty.trigger {
        Trigger::Start => "start",
        Trigger::Anchored => "anchored",
    };
    Json::object([
        (
            "phase",
            tables.phases[duty.phase.0 as usize].name.as_str().into(),
        ),
        ("trigger", trigger.into()),
        ("rules", Json::list(rules)),
    ])
}

/// Returns the verbs of a kind of bond for capture and release.
fn verbs(bond: BondKind) -> (&'static str, &'static str) {
    match bond {
        BondKind::Attract => ("magnetize", "switch_off"),
        BondKind::Suction => ("open", "close"),
        BondKind::Reject => ("expect", "reject"),
    }
}

fn condition(tables: &Tables, duty: Duty<'_>, index: usize, condition: Condition) -> Value {
    match condition {
        Condition::Turn(needed) => {
            let of: Vec<&str> = duty
                .given_before(index)
                .map(|role| tables.name(role))
                .collect();
            json!({ "turn": { "enough": needed, "of": of } })
        }
        Condition::Docked(role) => json!({ "docked": tables.name(role) }),
        Condition::Asked(role) => json!({ "asked": tables.name(role) }),
        Condition::Released(role) => json!({ "released": tables.name(role) }),
        Condition::Notified(what) => json!({ "notified": notification(tables, what) }),
    }
}

fn action(tables: &Tables, action: Action) -> Value {
    let (capture, release) = verbs(tables.bond);
    match action {
        Action::Magnetize { face, child, cell } => {
            json!({ "do": capture, "face": face, "child": tables.name(child), "cell": cell })
        }
        Action::AskRelease => json!({ "do": "ask_release" }),
        Action::AskReleaseLater(ticks) => json!({ "do": "ask_release", "after": ticks }),
        Action::SwitchOff { face, child } => {
            json!({ "do": release, "face": face, "child": tables.name(child) })
        }
        Action::Notify {
            to,
            notification: what,
        } => {
            json!({ "do": "notify", "to": tables.name(to), "notification": notification(tables, what) })
        }
        Action::Report => json!({ "do": "report" }),
    }
}

fn notification(tables: &Tables, notification: Notification) -> Value {
    match notification {
        Notification::Anchored(role) => json!({ "anchored": tables.name(role) }),
        Notification::Released(role) => json!({ "released": tables.name(role) }),
    }
}
