//! Many equations at once, on all cores.

use crate::error::MfdmError;
use crate::parallel::{CHUNK, Pool, take_from_rooms};
use crate::solver::csr::CsrMaker;
use crate::system::{LinearSystem, Roles};
use std::ops::Range;

/// A system whose equations are made on all cores.
pub(crate) struct SystemMaker {
    system: LinearSystem, // without its matrix
    rows: CsrMaker,
}

impl SystemMaker {
    /// No equation yet, of all that the unknowns will have.
    pub fn new(roles: &Roles) -> Self {
        let system = LinearSystem::new(roles.n_unknowns, roles.n_holes);
        Self { system, rows: CsrMaker::new(roles.n_unknowns, roles.n_unknowns) }
    }

    /// Appends the equations of consecutive unknowns; few are held beside the system. `equation` appends that of an unknown,
    /// with the help of a `worker`, of which there are no more than threads; what it tells of it comes back in order.
    ///
    /// # Errors
    /// The first that an equation has.
    pub fn extend<W: Send, T: Send>(
        &mut self,
        unknowns: Range<usize>,
        worker: impl Fn() -> W + Sync + Send,
        equation: impl Fn(&mut W, usize, &mut LinearSystem) -> Result<T, MfdmError> + Sync + Send,
    ) -> Result<Vec<T>, MfdmError> {
        let Self { system, rows } = self;
        let (n, n_holes) = (system.matrix.n_columns(), system.hole_columns.len());
        let workers = Pool::new(worker);
        let work = |piece: Range<usize>, (room, told): &mut (LinearSystem, Result<Vec<T>, MfdmError>)| {
            room.clear();
            *told = workers.with(|worker| piece.map(|k| equation(worker, k, room)).collect());
        };
        let mut all = Ok(Vec::with_capacity(unknowns.len()));
        take_from_rooms(
            unknowns,
            CHUNK,
            || (LinearSystem::new(n, n_holes), Ok(Vec::new())),
            work,
            |made| {
                for (room, told) in made.iter_mut() {
                    match (&mut all, std::mem::replace(told, Ok(Vec::new()))) {
                        (Ok(all), Ok(told)) => all.extend(told),
                        (Ok(_), Err(error)) => all = Err(error),
                        (Err(_), _) => {}
                    }
                    system.append_all_but_rows(room);
                }
                rows.append(made.iter().map(|(room, _)| &room.matrix).collect());
            },
        );
        all
    }

    /// The system of the equations so far.
    pub fn system(mut self) -> LinearSystem {
        self.system.matrix = self.rows.matrix();
        self.system
    }
}
