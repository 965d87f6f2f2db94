//! What is to be done next for an ensemble on a cluster.
use std::collections::BTreeSet;

use super::queue::active;
use super::{FoundPieces, Queue, SlurmJob};

/// What whoever follows an ensemble knows of it; the rest is asked for each time.
#[derive(Clone, Debug)]
pub struct Workflow {
    /// How often pieces are submitted, and then the job that puts them together.
    attempts: u64,
    /// Job arrays that were submitted or met.
    arrays: BTreeSet<u64>,
    /// Jobs that put pieces together, the same.
    merges: BTreeSet<u64>,
    /// How often such a job was submitted when all pieces were there.
    tries: u64,
    /// Whether all pieces were there, the last time that somebody looked.
    is_complete: bool,
    /// Jobs that were ended by somebody else.
    cancelled: bool,
}

/// What is to be done next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WorkflowStep {
    /// To ask again later.
    Wait,
    /// To submit an array that makes these pieces, and a job after it; jobs that wait to put together what is not there are
    /// cancelled before.
    Pieces {
        /// Their numbers.
        missing: Vec<u64>,
        /// The numbers of the jobs.
        cancel: Vec<u64>,
    },
    /// To submit a job that puts the pieces together.
    Merge {
        /// The arrays for which it waits.
        after: Vec<u64>,
    },
    /// Nothing: all is put together.
    Done,
    /// Nothing more can be done.
    Stop(Stop),
}

/// Why no more is submitted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stop {
    /// These pieces were submitted as often as was asked for.
    Missing(Vec<u64>),
    /// Somebody else has cancelled jobs; these pieces are missing.
    Cancelled(Vec<u64>),
    /// All pieces are there, but the jobs that put them together fail.
    Unmerged,
}

impl Workflow {
    /// Of an ensemble whose pieces are submitted so many times; what is queued already counts.
    pub fn new(attempts: u64) -> Workflow {
        Workflow {
            attempts,
            arrays: BTreeSet::new(),
            merges: BTreeSet::new(),
            tries: 0,
            is_complete: false,
            cancelled: false,
        }
    }

    /// How often pieces were submitted.
    pub fn attempts(&self) -> u64 {
        self.arrays.len() as u64
    }

    /// All jobs that were submitted or met.
    pub fn jobs(&self) -> Vec<u64> {
        self.arrays.iter().chain(&self.merges).copied().collect()
    }

    /// Notes what was submitted.
    pub fn submitted(&mut self, array: Option<u64>, merge: Option<u64>) {
        self.tries += u64::from(self.is_complete && merge.is_some());
        self.arrays.extend(array);
        self.merges.extend(merge);
    }

    /// Says what is to be done, by what Slurm says of the jobs, and by a look at the pieces, which takes long and is taken
    /// when no job makes any.
    ///
    /// # Errors
    /// Those of the look.
    pub fn next<E>(
        &mut self,
        queue: &Queue,
        look: impl FnOnce(/* is_thorough */ bool) -> Result<FoundPieces, E>,
    ) -> Result<WorkflowStep, E> {
        let (making, merging) = (active(&queue.pieces), active(&queue.merges));
        self.arrays.extend(&making);
        self.merges.extend(&merging);
        let is_known =
            |job: &SlurmJob| self.arrays.contains(&job.number) || self.merges.contains(&job.number);
        self.cancelled |= queue.jobs().any(|job| job.is_cancelled() && is_known(job));
        if !making.is_empty() {
            // Tasks that somebody has cancelled may take a while to end.
            return Ok(match merging.is_empty() && !self.cancelled {
                true => WorkflowStep::Merge { after: making },
                false => WorkflowStep::Wait,
            });
        }
        // Pieces are gone while they are put together.
        let runs = |job: &SlurmJob| job.is_active() && !job.is_pending();
        if queue.merges.iter().any(runs) || self.is_complete && !merging.is_empty() {
            return Ok(WorkflowStep::Wait);
        }
        // Whoever puts them together reads all of them, and may have found one damaged.
        let is_thorough = self.is_complete;
        Ok(match look(is_thorough)? {
            FoundPieces::Merged => WorkflowStep::Done,
            FoundPieces::AllBut(missing) if missing.is_empty() => {
                self.is_complete = true;
                match () {
                    () if !merging.is_empty() => WorkflowStep::Wait,
                    () if self.cancelled => WorkflowStep::Stop(Stop::Cancelled(missing)),
                    () if self.tries >= self.attempts => WorkflowStep::Stop(Stop::Unmerged),
                    () => WorkflowStep::Merge { after: Vec::new() },
                }
            }
            FoundPieces::AllBut(missing) if self.cancelled => {
                WorkflowStep::Stop(Stop::Cancelled(missing))
            }
            FoundPieces::AllBut(missing) if self.attempts() >= self.attempts => {
                WorkflowStep::Stop(Stop::Missing(missing))
            }
            FoundPieces::AllBut(missing) => {
                self.is_complete = false;
                // It is not somebody else who cancels these.
                self.merges.clear();
                let cancel = merging;
                WorkflowStep::Pieces { missing, cancel }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn queue(lines: &[&str]) -> Queue {
        Queue::read(&lines.join("\n"), "a")
    }

    /// What is done next, where the pieces that are missing are these.
    fn next(workflow: &mut Workflow, lines: &[&str], missing: &[u64]) -> WorkflowStep {
        let found = |_| Ok::<_, ()>(FoundPieces::AllBut(missing.to_vec()));
        workflow.next(&queue(lines), found).unwrap()
    }

    fn pieces(missing: &[u64], cancel: &[u64]) -> WorkflowStep {
        let (missing, cancel) = (missing.to_vec(), cancel.to_vec());
        WorkflowStep::Pieces { missing, cancel }
    }

    #[test]
    fn what_is_missing_is_submitted_so_many_times() {
        let mut workflow = Workflow::new(2);
        let step = next(&mut workflow, &[], &[0, 1, 2]);
        assert_eq!(step, pieces(&[0, 1, 2], &[]));
        workflow.submitted(Some(1), Some(2));
        let running = ["1|0-2|a|RUNNING|None", "2|N/A|a-merge|PENDING|Dependency"];
        let look = |_| -> Result<FoundPieces, ()> { panic!("nobody looks while pieces are made") };
        assert_eq!(
            workflow.next(&queue(&running), look),
            Ok(WorkflowStep::Wait)
        );
        let over = [
            "1|0-2|a|FAILED|NonZeroExitCode",
            "2|N/A|a-merge|PENDING|Priority",
        ];
        assert_eq!(next(&mut workflow, &over, &[1]), pieces(&[1], &[2]));
        workflow.submitted(Some(3), Some(4));
        // That it was cancelled is known.
        let over = [
            "2|N/A|a-merge|CANCELLED|None",
            "3|1|a|FAILED|NonZeroExitCode",
        ];
        let step = next(&mut workflow, &over, &[1]);
        assert_eq!(step, WorkflowStep::Stop(Stop::Missing(vec![1])));
    }

    /// Whoever cancels is obeyed, also while tasks take a while to end.
    #[test]
    fn nothing_is_submitted_while_what_was_cancelled_ends() {
        let mut workflow = Workflow::new(3);
        next(&mut workflow, &[], &[0, 1, 2]);
        workflow.submitted(Some(1), Some(2));
        let ending = ["1|0-2|a|COMPLETING|None", "2|N/A|a-merge|CANCELLED|None"];
        assert_eq!(next(&mut workflow, &ending, &[0]), WorkflowStep::Wait);
        let over = ["1|0-2|a|CANCELLED|None", "2|N/A|a-merge|CANCELLED|None"];
        let step = next(&mut workflow, &over, &[0]);
        assert_eq!(step, WorkflowStep::Stop(Stop::Cancelled(vec![0])));
    }

    #[test]
    fn what_is_queued_is_followed() {
        let mut workflow = Workflow::new(1);
        let waiting = [
            "7|0-2|a|PENDING|Resources",
            "8|N/A|a-merge|PENDING|Dependency",
        ];
        assert_eq!(next(&mut workflow, &waiting, &[0]), WorkflowStep::Wait);
        assert_eq!(workflow.attempts(), 1);
        let after = vec![7];
        assert_eq!(
            next(&mut workflow, &waiting[..1], &[0]),
            WorkflowStep::Merge { after }
        );
        let step = next(&mut workflow, &[], &[0]);
        assert_eq!(step, WorkflowStep::Stop(Stop::Missing(vec![0])));
        let merged = workflow.next(&Queue::default(), |_| Ok::<_, ()>(FoundPieces::Merged));
        assert_eq!(merged, Ok(WorkflowStep::Done));
    }

    #[test]
    fn nobody_looks_while_pieces_are_put_together() {
        let mut workflow = Workflow::new(1);
        let merging = ["8|N/A|a-merge|RUNNING|None"];
        let look = |_| -> Result<FoundPieces, ()> { panic!("they are being removed") };
        assert_eq!(
            workflow.next(&queue(&merging), look),
            Ok(WorkflowStep::Wait)
        );
    }

    #[test]
    fn a_merge_that_fails_is_tried_again_after_a_thorough_look() {
        let mut workflow = Workflow::new(2);
        let after = vec![];
        assert_eq!(next(&mut workflow, &[], &[]), WorkflowStep::Merge { after });
        workflow.submitted(None, Some(5));
        let failed = queue(&["5|N/A|a-merge|FAILED|NonZeroExitCode"]);
        let damaged = |is_thorough: bool| match is_thorough {
            true => Ok::<_, ()>(FoundPieces::AllBut(vec![3])),
            false => panic!("the first lines have been looked at"),
        };
        let step = workflow.clone().next(&failed, damaged).unwrap();
        assert_eq!(step, pieces(&[3], &[]));
        let sound = |_| Ok::<_, ()>(FoundPieces::AllBut(vec![]));
        assert!(matches!(
            workflow.next(&failed, sound),
            Ok(WorkflowStep::Merge { .. })
        ));
        workflow.submitted(None, Some(6));
        let step = workflow.next(&failed, sound);
        assert_eq!(step, Ok(WorkflowStep::Stop(Stop::Unmerged)));
    }

    #[test]
    fn what_somebody_has_cancelled_is_not_submitted_again() {
        let old = ["1|0-2|a|CANCELLED|None", "2|N/A|a-merge|CANCELLED|None"];
        let mut workflow = Workflow::new(3);
        assert_eq!(next(&mut workflow, &old, &[0]), pieces(&[0], &[]));
        workflow.submitted(Some(3), Some(4));
        let step = next(&mut workflow, &["3|0|a|CANCELLED|None"], &[0]);
        assert_eq!(step, WorkflowStep::Stop(Stop::Cancelled(vec![0])));
    }
}
