//! A thread that always works on the newest of what it is asked.

use polygonizer::Cancel;
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;

/// Trees are walked by recursion; as deep as scenes may be, this is plenty.
const STACK_BYTES: usize = 32 << 20;

/// A worker with one question at a time: a newer one takes the place of one that waits, and the work on an older one
/// hears that it is no longer the newest.
///
/// `Q` is a question, `A` an answer; a question may have several. The thread ends when this is dropped.
#[derive(Debug)]
pub struct Newest<Q, A> {
    desk: Arc<Desk<Q>>,
    answers: Receiver<A>,
}

#[derive(Debug)]
struct Desk<Q> {
    waiting: Mutex<Waiting<Q>>,
    arrived: Condvar,
}

#[derive(Debug)]
struct Waiting<Q> {
    question: Option<Q>,
    /// Stops the work on the question that was taken last.
    current: Cancel,
    /// Set when nobody can ask any more.
    closed: Cancel,
}

/// How a worker gives its answers and hears that they are no longer wanted.
pub struct Answering<A> {
    /// Set as soon as a newer question is there.
    pub cancel: Cancel,
    /// Set when nobody waits for answers any more.
    pub closed: Cancel,
    answers: Sender<A>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl<A> Answering<A> {
    /// Gives an answer, unless a newer question is there.
    pub fn give(&self, answer: A) {
        if !self.cancel.is_cancelled() {
            self.give_late(answer);
        }
    }

    /// Gives an answer even if a newer question is there.
    pub fn give_late(&self, answer: A) {
        if self.answers.send(answer).is_ok() {
            (self.wake)();
        }
    }
}

impl<Q: Send + 'static, A: Send + 'static> Newest<Q, A> {
    /// Starts a thread that hands each question to `work`, and calls `wake` after each answer.
    ///
    /// Errors: a system without a thread to spare.
    pub fn start(
        name: &str,
        wake: Arc<dyn Fn() + Send + Sync>,
        mut work: impl FnMut(Q, &Answering<A>) + Send + 'static,
    ) -> std::io::Result<Self> {
        let waiting = Waiting { question: None, current: Cancel::new(), closed: Cancel::new() };
        let closed = waiting.closed.clone();
        let desk = Arc::new(Desk { waiting: Mutex::new(waiting), arrived: Condvar::new() });
        let (sender, answers) = mpsc::channel();
        let own = desk.clone();
        thread::Builder::new().name(name.into()).stack_size(STACK_BYTES).spawn(move || {
            while let Some((question, cancel)) = own.next() {
                let (closed, answers, wake) = (closed.clone(), sender.clone(), wake.clone());
                work(question, &Answering { cancel, closed, answers, wake });
            }
        })?;
        Ok(Self { desk, answers })
    }

    /// Asks, instead of whatever was asked before.
    pub fn ask(&self, question: Q) {
        let mut waiting = self.desk.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.current.cancel();
        waiting.question = Some(question);
        self.desk.arrived.notify_one();
    }

    /// Nothing that was asked is wanted any more.
    pub fn stop(&self) {
        let mut waiting = self.desk.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.current.cancel();
        waiting.question = None;
    }

    /// The answers since the last look, oldest first. Some may still be to questions before the newest.
    pub fn answers(&self) -> impl Iterator<Item = A> {
        self.answers.try_iter()
    }
}

impl<Q> Desk<Q> {
    /// Waits for a question; `None` when nobody can ask any more.
    fn next(&self) -> Option<(Q, Cancel)> {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if waiting.closed.is_cancelled() {
                return None;
            }
            if let Some(question) = waiting.question.take() {
                waiting.current = Cancel::new();
                return Some((question, waiting.current.clone()));
            }
            waiting = self.arrived.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl<Q, A> Drop for Newest<Q, A> {
    fn drop(&mut self) {
        let waiting = self.desk.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.closed.cancel();
        waiting.current.cancel();
        self.desk.arrived.notify_one();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    #[test]
    fn a_newer_question_stops_the_work_on_an_older_one_and_is_answered() {
        let slow = Newest::start("slow", Arc::new(|| ()), |question: u32, answering: &Answering<u32>| {
            while question == 1 && !answering.cancel.is_cancelled() {
                thread::sleep(Duration::from_millis(1));
            }
            answering.give(question);
        });
        let slow = slow.expect("a thread");
        slow.ask(1);
        thread::sleep(Duration::from_millis(20));
        slow.ask(2);
        slow.ask(3);
        let until = Instant::now() + Duration::from_secs(20);
        let mut given = Vec::new();
        while given.last() != Some(&3) && Instant::now() < until {
            given.extend(slow.answers());
            thread::sleep(Duration::from_millis(1));
        }
        assert!(given.ends_with(&[3]) && !given.contains(&1), "{given:?}");
    }
}
