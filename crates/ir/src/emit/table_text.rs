//! Event tables as text: stable and sorted, for comparison line by line.
use std::fmt::{self, Display, Formatter, Write};

use super::Text;
use crate::scene::BondKind;
use crate::table::{Action, Condition, Duty, Notification, PhaseId, RoleId, Rule, Tables, Trigger};
use stochc_text::counted;

/// Returns the text form of event tables.
pub fn table_text(tables: &Tables) -> impl Display {
    Text(move |out: &mut Formatter<'_>| match tables.aggregate {
        Some(size) => write_aggregate(out, tables, size),
        None => write_tables(out, tables),
    })
}

fn write_tables(out: &mut Formatter<'_>, tables: &Tables) -> fmt::Result {
    let count = |noun: &str| match tables.faces {
        1 => format!("one {noun}"),
        n => format!("{n} {noun}s"),
    };
    let bond = match tables.bond {
        BondKind::Attract => format!("blocks magnetize {} at a time", count("face")),
        BondKind::Suction => format!("blocks open {} at a time", count("valve")),
        BondKind::Reject => "every face always attracts".to_owned(),
    };
    writeln!(out, "assembly {}", tables.assembly)?;
    writeln!(
        out,
        "plate {} x {}, {bond}",
        tables.plate.width, tables.plate.depth
    )?;
    if tables.bond.is_passive() {
        writeln!(out, "otherwise: reject what docks on any other face")?;
    }
    out.write_char('\n')?;
    for phase in &tables.phases {
        if phase.pre_attached {
            writeln!(
                out,
                "phase {}: pre-attached, before the first tick",
                phase.name
            )?;
            continue;
        }
        write!(
            out,
            "phase {}: ends after {}",
            phase.name,
            counted(phase.reports as usize, "report")
        )?;
        if phase.wait > 0 {
            write!(out, " and at least {} ticks", phase.wait)?;
        }
        match phase.timeout {
            Some(ticks) => {
                let what = phase.recovery.map_or("fails", |_| "aborts");
                writeln!(out, ", {what} after {ticks} ticks")?;
            }
            None => out.write_char('\n')?,
        }
        if let Some(recovery) = phase.recovery {
            let reports = counted(recovery.reports as usize, "report");
            let retries = counted(recovery.retries as usize, "retry");
            write!(out, "    retried after {reports}")?;
            if recovery.pause > 0 {
                write!(out, " and {} ticks", recovery.pause)?;
            }
            writeln!(out, "; fails after {retries}")?;
        }
    }
    let mut role = None;
    for duty in tables.duties() {
        if role != Some(duty.role) {
            role = Some(duty.role);
            write!(out, "\nblock {}", tables.name(duty.role))?;
            match tables.roles[duty.role.0 as usize].seed {
                Some(cell) => {
                    writeln!(out, ", seed at {cell}")?;
                }
                None => out.write_char('\n')?,
            }
        }
        write_duty(tables, duty, out)?;
    }
    Ok(())
}

/// Writes an aggregate, whose blocks have no rules.
fn write_aggregate(out: &mut Formatter<'_>, tables: &Tables, size: u32) -> fmt::Result {
    write!(
        out,
        "aggregate {}\nno plate: every face always attracts, until {size} free blocks are bonded\n\n",
        tables.assembly
    )?;
    for phase in &tables.phases {
        write!(
            out,
            "phase {0}: ends when a group has {0} blocks",
            phase.name
        )?;
        match phase.timeout {
            Some(ticks) => {
                writeln!(out, ", fails after {ticks} ticks")?;
            }
            None => out.write_char('\n')?,
        }
    }
    Ok(())
}

/// Returns the text form of one block's rules, without its name. Empty if it has none.
pub fn duties_text(tables: &Tables, role: RoleId) -> String {
    let mut out = String::new();
    for phase in (0..tables.phases.len() as u32).map(PhaseId) {
        for trigger in [Trigger::Start, Trigger::Anchored] {
            if let Some(duty) = tables.duty(role, phase, trigger) {
                // Writing to a string cannot fail.
                let _ = write_duty(tables, duty, &mut out);
            }
        }
    }
    out
}

fn write_duty(tables: &Tables, duty: Duty<'_>, out: &mut impl Write) -> fmt::Result {
    let phase = &tables.phases[duty.phase.0 as usize].name;
    let trigger = match duty.trigger {
        Trigger::Start => "at the start of",
        Trigger::Anchored => "when anchored in",
    };
    writeln!(out, "    {trigger} {phase}")?;
    for (index, rule) in duty.rules().enumerate() {
        writeln!(out, "        {}", rule_text(tables, duty, index, rule))?;
    }
    Ok(())
}

fn rule_text(tables: &Tables, duty: Duty<'_>, index: usize, rule: Rule<'_>) -> String {
    let mut text = String::new();
    for (i, condition) in rule.when.iter().enumerate() {
        text.push_str(if i == 0 { "once " } else { " and " });
        let name = |role| tables.name(role);
        let _ = match *condition {
            Condition::Docked(role) => write!(text, "{} has docked", name(role)),
            Condition::Asked(role) => write!(text, "{} asks", name(role)),
            Condition::Released(role) => write!(text, "{} has gone", name(role)),
            Condition::Notified(notification) => write!(
                text,
                "notified that {}",
                notification_text(tables, notification)
            ),
            Condition::Turn(needed) => {
                let given: Vec<&str> = duty.given_before(index).map(name).collect();
                let have = if needed == 1 { "has" } else { "have" };
                write!(text, "{needed} of {} {have} docked", given.join(", "))
            }
        };
    }
    if !rule.when.is_empty() {
        text.push_str(": ");
    }
    let name = |role| tables.name(role);
    let _ = match rule.then {
        Action::Magnetize { face, child, cell } => {
            let child = name(child);
            match tables.bond {
                BondKind::Attract => write!(text, "magnetize {face} for {child} at {cell}"),
                BondKind::Suction => write!(text, "open {face} for {child} at {cell}"),
                BondKind::Reject => write!(text, "expect {face} -> {child} at {cell}"),
            }
        }
        Action::AskRelease => write!(text, "ask to be released"),
        Action::AskReleaseLater(ticks) => {
            write!(text, "after {ticks} ticks, ask to be released")
        }
        Action::SwitchOff { face, child } => {
            let child = name(child);
            match tables.bond {
                BondKind::Attract => write!(text, "switch {face} off, which frees {child}"),
                BondKind::Suction => write!(text, "close {face}, which frees {child}"),
                BondKind::Reject => write!(text, "reject {face}, which frees {child}"),
            }
        }
        Action::Notify { to, notification } => {
            write!(
                text,
                "notify {} that {}",
                name(to),
                notification_text(tables, notification)
            )
        }
        Action::Report => write!(text, "report to the plate"),
    };
    text
}

fn notification_text(tables: &Tables, notification: Notification) -> String {
    match notification {
        Notification::Anchored(role) => format!("{} is anchored", tables.name(role)),
        Notification::Released(role) => format!("{} is released", tables.name(role)),
    }
}
