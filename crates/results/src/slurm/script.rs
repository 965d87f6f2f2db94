//! Scripts of the jobs, for a POSIX shell.
use stochc_files::shell::quoted;

use crate::folder::slurm_folder::SLURM;

/// Returns the script of a job array. Task i runs `per_task` shards, starting at shard i ×
/// `per_task`. `folder` is an absolute path, and `stochc` is the path of the command on every node.
///
/// The script writes its own log, because Slurm replaces some characters in the name of a log. A
/// task that succeeds leaves no log.
pub fn shards_script(stochc: &str, folder: &str, shards: u64, per_task: u64) -> String {
    let names = names(stochc, folder);
    format!(
        r#"#!/bin/sh
# Task I runs the shards from I x per_task. It skips finished shards.
{names}log="$folder/{SLURM}/${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID.log"
exec >"$log" 2>&1
shards={shards}
per_task={per_task}
shard=$((SLURM_ARRAY_TASK_ID * per_task))
end=$((shard + per_task))
[ "$end" -le "$shards" ] || end=$shards
status=0
while [ "$shard" -lt "$end" ] && [ "$status" != 130 ]; do
    "$stochc" shard run "$folder" "$shard" --quiet --threads "${{SLURM_CPUS_ON_NODE:-1}}" || {{
        status=$?
        echo "shard $shard ended with status $status"
    }}
    shard=$((shard + 1))
done
[ "$status" != 0 ] || rm -f "$log"
exit "$status"
"#
    )
}

/// Returns the script of the merge job.
///
/// It writes a log only if it fails, because `stochc shard merge` removes the folder of logs.
pub fn merge_script(stochc: &str, folder: &str) -> String {
    let names = names(stochc, folder);
    format!(
        r#"#!/bin/sh
# Merges the shards.
{names}output=$("$stochc" shard merge "$folder" --quiet 2>&1) || {{
    status=$?
    printf '%s\n' "$output" >"$folder/{SLURM}/merge_$SLURM_JOB_ID.log"
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
    fn the_shell_expands_no_name() {
        let odd = "/tmp/it's \"$HOME\" `x`\nnew";
        let quoted = "folder='/tmp/it'\\''s \"$HOME\" `x`\nnew'\n";
        assert!(shards_script("stochc", odd, 3, 1).contains(quoted));
        assert!(merge_script("stochc", odd).contains(quoted));
    }
}
