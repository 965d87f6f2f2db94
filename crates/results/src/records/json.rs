//! Self-contained JSON of a run's record.
use serde_json::{Value, json};
use stochc_ir::record::RunRecord;
use stochc_ir::table::{PhaseId, RoleId};

use crate::EnsembleProgram;

/// Returns a record with added names. Each index of a phase or role is followed by `phase_name`,
/// `parent_name`, `child_name` or `role_name`.
pub fn record_json(record: &RunRecord, program: &EnsembleProgram) -> Value {
    let mut value = serde_json::to_value(record).expect("a record is plain data");
    name(&mut value, program);
    value["program"] = json!(program.name);
    value["phase_names"] = json!(
        program
            .phases()
            .iter()
            .map(|phase| &phase.name)
            .collect::<Vec<_>>()
    );
    value["tick"] = json!(program.scene.tick);
    value["seconds"] = json!(record.ticks as f64 * program.scene.tick);
    value
}

fn name(value: &mut Value, program: &EnsembleProgram) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(|value| name(value, program)),
        Value::Object(fields) => {
            for key in ["phase", "parent", "child", "role"] {
                let index = fields.get(key).and_then(Value::as_u64);
                let Some(index) = index.and_then(|index| u32::try_from(index).ok()) else {
                    continue;
                };
                let called = match key {
                    "phase" => program.phase(PhaseId(index)),
                    _ => program.role(RoleId(index)),
                };
                fields.insert(format!("{key}_name"), json!(called));
            }
            fields.values_mut().for_each(|value| name(value, program));
        }
        _ => {}
    }
}
