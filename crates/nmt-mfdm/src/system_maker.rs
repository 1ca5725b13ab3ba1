//! Many equations at once, on all cores.

use crate::error::MfdmError;
use crate::parallel::{CHUNK, Pool, fill_pairs};
use crate::solver::csr::CsrMaker;
use crate::system::{LinearSystem, Roles};
use std::ops::Range;

/// Pieces of equations that are made before they are put in their places.
const ROOMS: usize = 64;

/// A system whose equations are made on all cores, by workers W.
pub(crate) struct SystemMaker<W> {
    system: LinearSystem, // without its matrix
    rows: CsrMaker,
    rooms: Vec<LinearSystem>, // for the equations of a piece each, again and again
    workers: Pool<W>,
}

impl<W: Send> SystemMaker<W> {
    /// No equation yet, of all that the unknowns will have.
    pub fn new(roles: &Roles) -> Self {
        let mut system = LinearSystem::new(roles.n_unknowns, roles.n_holes);
        system.rhs.reserve_exact(roles.n_unknowns);
        system.is_beside.reserve_exact(roles.n_unknowns);
        Self {
            system,
            rows: CsrMaker::new(roles.n_unknowns, roles.n_unknowns),
            rooms: Vec::new(),
            workers: Pool::default(),
        }
    }

    /// Appends the equations of consecutive unknowns; few are held beside the system. `equation` appends that of an unknown,
    /// with the help of a `worker`, of which there are no more than threads, for all calls; what it tells of it comes back in
    /// order.
    ///
    /// # Errors
    /// The first that an equation has.
    pub fn extend<T: Send>(
        &mut self,
        unknowns: Range<usize>,
        worker: impl Fn() -> W + Sync + Send,
        equation: impl Fn(&mut W, usize, &mut LinearSystem) -> Result<T, MfdmError> + Sync + Send,
    ) -> Result<Vec<T>, MfdmError> {
        let Self { system, rows, rooms, workers } = self;
        let mut all = Vec::with_capacity(unknowns.len());
        for first in unknowns.clone().step_by(ROOMS * CHUNK) {
            let n_pieces = (unknowns.end - first).div_ceil(CHUNK).min(ROOMS);
            let piece = |k: usize| first + k * CHUNK..(first + (k + 1) * CHUNK).min(unknowns.end);
            let room = || LinearSystem::new(system.matrix.n_columns(), system.hole_columns.len());
            rooms.resize_with(n_pieces.max(rooms.len()), room);
            let rooms = &mut rooms[..n_pieces];
            let mut told: Vec<Result<Vec<T>, MfdmError>> = (0..n_pieces).map(|_| Ok(Vec::new())).collect();
            fill_pairs((rooms, &mut told), 1, |k, rooms, told| {
                for (room, told) in rooms.iter_mut().zip(told) {
                    room.clear();
                    *told = workers.with(&worker, |worker| {
                        let mut of_piece = Vec::with_capacity(CHUNK);
                        for k in piece(k) {
                            of_piece.push(equation(worker, k, room)?);
                        }
                        Ok(of_piece)
                    });
                }
            });
            for (room, told) in rooms.iter().zip(told) {
                all.extend(told?);
                system.append_all_but_rows(room);
            }
            rows.append(rooms.iter().map(|room| &room.matrix).collect());
        }
        Ok(all)
    }

    /// The system of the equations so far.
    pub fn system(mut self) -> LinearSystem {
        self.system.matrix = self.rows.matrix();
        self.system
    }
}
