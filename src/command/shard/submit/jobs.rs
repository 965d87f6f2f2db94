//! Scripts and `sbatch` commands that run the shards of an ensemble.
use std::path::PathBuf;

use stochc_results::slurm::{
    SlurmEnsemble, SlurmLimits, indices, merge_script, shards_script, tasks,
};

use super::arguments::SubmitArguments;
use super::slurm;
use crate::exit::Failure;

/// Scripts and `sbatch` commands that run the shards of an ensemble.
pub struct Jobs<'a> {
    options: &'a SubmitArguments,
    ensemble: &'a SlurmEnsemble,
    stochc: String,
    folder: String,
}

impl<'a> Jobs<'a> {
    /// Returns the scripts and commands for an ensemble.
    pub fn new(
        options: &'a SubmitArguments,
        ensemble: &'a SlurmEnsemble,
    ) -> Result<Jobs<'a>, Failure> {
        let stochc = std::env::current_exe()
            .map_err(|error| Failure::usage(format!("cannot locate this command: {error}")))?;
        Ok(Jobs {
            options,
            ensemble,
            stochc: text(stochc)?,
            folder: text(ensemble.path.clone())?,
        })
    }

    /// Returns the number of shards that each task runs.
    ///
    /// # Errors
    /// If the cluster has no job arrays.
    pub fn per_task(&self, limits: SlurmLimits) -> Result<u64, Failure> {
        let per_task = limits.per_task(self.ensemble.shards, self.options.per_task);
        per_task.ok_or_else(|| {
            Failure::usage(
                "this site allows no job arrays (MaxArraySize is 0); submit `stochc shard run` yourself, shard by shard",
            )
        })
    }

    /// Returns the scripts of the job array and of the merge job.
    pub fn scripts(&self, per_task: u64) -> [String; 2] {
        let shards = self.ensemble.shards;
        [
            shards_script(&self.stochc, &self.folder, shards, per_task),
            merge_script(&self.stochc, &self.folder),
        ]
    }

    /// Returns the arguments of `sbatch` for a job array with these tasks.
    pub fn array(&self, tasks: &[u64], script: &str) -> Vec<String> {
        let indices = indices(tasks, self.options.at_most);
        self.arguments(&self.ensemble.name, format!("--array={indices}"), script)
    }

    /// Returns the arguments of `sbatch` for a merge job that waits for these job arrays.
    pub fn merge(&self, arrays: &[String], script: &str) -> Vec<String> {
        let dependency = format!("--dependency=afterany:{}", arrays.join(":"));
        self.arguments(&self.ensemble.merge_name(), dependency, script)
    }

    fn arguments(&self, name: &str, own: String, script: &str) -> Vec<String> {
        let given = [
            ("partition", &self.options.partition),
            ("time", &self.options.time),
        ];
        let given = given.into_iter().filter_map(|(option, value)| {
            value.as_ref().map(|value| format!("--{option}={value}"))
        });
        let mut arguments: Vec<String> = given.chain(self.options.sbatch.iter().cloned()).collect();
        arguments.extend([
            "--parsable".to_owned(),
            format!("--job-name={name}"),
            "--chdir=/".to_owned(),
            "--output=/dev/null".to_owned(),
            own,
            script.to_owned(),
        ]);
        arguments
    }

    /// Returns the scripts and commands that would run the missing shards, as text.
    pub fn preview(&self, missing: &[u64]) -> Result<String, Failure> {
        // The preview also works without Slurm, with default limits.
        let per_task = self.per_task(slurm::limits().unwrap_or_default())?;
        let [shards, merge] = self.scripts(per_task);
        let script = |name: &str| format!("{}/slurm/{name}.sh", self.folder);
        let array = self.array(&tasks(missing, per_task), &script("shards"));
        let array = slurm::line("sbatch", &array);
        let last = slurm::line("sbatch", &self.merge(&["JOB".to_owned()], &script("merge")));
        let count = missing.len();
        Ok(format!(
            "# slurm/shards.sh\n{shards}\n# runs the missing shards: {count}\n{array}\n\n\
             # slurm/merge.sh\n{merge}\n# merges the shards\n{last}\n"
        ))
    }
}

fn text(path: PathBuf) -> Result<String, Failure> {
    path.into_os_string().into_string().map_err(|path| {
        Failure::usage(format!(
            "`{}` is not UTF-8, so no script can name it; rename it",
            path.to_string_lossy()
        ))
    })
}
