//! Who is to be looked at before which step.

use super::mover::Slot;

/// The calendar has pages for so many steps ahead; who is due later is entered anew then.
const PAGES: u64 = 32;

const NEVER: u64 = u64::MAX;

/// For each of the coming steps the bodies that may leave their cells in it.
///
/// Within a step their order means nothing, so this is cheaper than a schedule. A body whose
/// day comes later than was foretold stays on its page until then: so the pages do not fill
/// however often it changes its mind.
#[derive(Clone, Debug)]
pub struct Calendar {
    present: u64,
    pages: Vec<Vec<Slot>>,
    days: Vec<Day>,
}

#[derive(Clone, Copy, Debug)]
struct Day {
    /// The step in which the body is to be looked at.
    due: u64,
    /// The step on whose page it stands.
    page: u64,
}

impl Calendar {
    /// An empty calendar of the steps after the present one.
    pub fn new(present: u64) -> Calendar {
        Calendar { present, pages: vec![Vec::new(); PAGES as usize], days: Vec::new() }
    }

    /// Makes room for one more body.
    pub fn add_body(&mut self) {
        self.days.push(Day { due: NEVER, page: NEVER });
    }

    /// Enters a body so many steps ahead, at least one.
    pub fn note(&mut self, slot: Slot, ahead: u32) {
        self.days[slot as usize].due = self.present + u64::from(ahead);
        self.enter(slot);
    }

    /// Strikes a body out.
    pub fn forget(&mut self, slot: Slot) {
        self.days[slot as usize].due = NEVER;
    }

    fn enter(&mut self, slot: Slot) {
        let day = &mut self.days[slot as usize];
        let last = self.present + PAGES - 1;
        let page = if day.due < last { day.due } else { last };
        if page < day.page {
            day.page = page;
            self.pages[(page % PAGES) as usize].push(slot);
        }
    }

    /// Whether nobody stands on the page of the next step.
    pub fn is_free(&self) -> bool {
        self.pages[((self.present + 1) % PAGES) as usize].is_empty()
    }

    /// Goes on to the next step, whose page is empty.
    pub fn pass(&mut self) {
        self.present += 1;
    }

    /// Goes on to the next step and collects who is due in it.
    pub fn turn_page(&mut self, due: &mut Vec<Slot>) {
        self.present += 1;
        let place = (self.present % PAGES) as usize;
        let mut page = std::mem::take(&mut self.pages[place]);
        for slot in page.drain(..) {
            let day = &mut self.days[slot as usize];
            if day.page != self.present {
                continue;
            }
            day.page = NEVER;
            if day.due <= self.present {
                due.push(slot);
            } else if day.due != NEVER {
                self.enter(slot);
            }
        }
        self.pages[place] = page;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due(calendar: &mut Calendar) -> Vec<Slot> {
        let mut due = Vec::new();
        calendar.turn_page(&mut due);
        due
    }

    #[test]
    fn a_body_is_due_on_the_last_day_it_was_noted_for() {
        let mut calendar = Calendar::new(7);
        (0..4).for_each(|_| calendar.add_body());
        calendar.note(0, 1);
        calendar.note(1, 1);
        calendar.note(1, 3);
        calendar.note(2, 3);
        calendar.note(2, 2);
        calendar.note(3, 100);
        assert_eq!(due(&mut calendar), [0]);
        assert_eq!(due(&mut calendar), [2]);
        assert_eq!(due(&mut calendar), [1]);
        assert!((11..107).all(|_| due(&mut calendar).is_empty()));
        assert_eq!(due(&mut calendar), [3]);
    }

    #[test]
    fn a_forgotten_body_is_never_due() {
        let mut calendar = Calendar::new(0);
        calendar.add_body();
        calendar.note(0, 40);
        calendar.forget(0);
        assert!((0..100).all(|_| due(&mut calendar).is_empty()));
    }
}
