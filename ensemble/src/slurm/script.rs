//! What a job does: scripts for a POSIX shell.
use stochc_files::shell::quoted;

use crate::slurm_folder::SLURM;

/// The script of a job array, whose task i makes the pieces from i times `per_task`, of so many; the pieces are those of the
/// folder at `folder`, a whole path, and `stochc` is where the command is on every node.
///
/// Where all goes well, a task leaves no log. It writes that by itself: in the name of a log Slurm puts something else for
/// some signs.
pub fn pieces_script(stochc: &str, folder: &str, pieces: u64, per_task: u64) -> String {
    let names = names(stochc, folder);
    format!(
        r#"#!/bin/sh
# Task I makes the pieces from I x per_task; those that are there are left alone.
{names}log="$folder/{SLURM}/${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID.log"
exec >"$log" 2>&1
pieces={pieces}
per_task={per_task}
piece=$((SLURM_ARRAY_TASK_ID * per_task))
end=$((piece + per_task))
[ "$end" -le "$pieces" ] || end=$pieces
status=0
while [ "$piece" -lt "$end" ] && [ "$status" != 130 ]; do
    "$stochc" shard "$folder" "$piece" --quiet --threads "${{SLURM_CPUS_ON_NODE:-1}}" || {{
        status=$?
        echo "piece $piece has ended with status $status"
    }}
    piece=$((piece + 1))
done
[ "$status" != 0 ] || rm -f "$log"
exit "$status"
"#
    )
}

/// The script of the job that puts the pieces together.
///
/// While all goes well, it has no log: the folder of logs is removed.
pub fn merge_script(stochc: &str, folder: &str) -> String {
    let names = names(stochc, folder);
    format!(
        r#"#!/bin/sh
# Puts the pieces together, when no task makes any.
{names}said=$("$stochc" merge "$folder" --quiet 2>&1) || {{
    status=$?
    printf '%s\n' "$said" >"$folder/{SLURM}/merge_$SLURM_JOB_ID.log"
    exit "$status"
}}
"#
    )
}

fn names(stochc: &str, folder: &str) -> String {
    format!("stochc={}\nfolder={}\n", quoted(stochc), quoted(folder))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_is_read_by_the_shell() {
        let odd = "/tmp/it's \"$HOME\" `x`\nnew";
        let quoted = "folder='/tmp/it'\\''s \"$HOME\" `x`\nnew'\n";
        assert!(pieces_script("stochc", odd, 3, 1).contains(quoted));
        assert!(merge_script("stochc", odd).contains(quoted));
    }
}
