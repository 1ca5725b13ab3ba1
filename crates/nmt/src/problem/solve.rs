//! `[solve]`: the keys of the file, the options of the command over them, and which formulation each belongs to.

use super::error::{Faults, Place};
use super::limits::{self, Refusal};
use super::poisson::PoissonDraft;
use super::read::{SubdomainDraft, option};
use super::schema::{Overrides, SolveSettings};
use super::tree::{Reader, SOLVE_KEYS, Table, Value};
use nmt_cloud::ClearanceUnit;
use nmt_curve::Division;
use nmt_mfdm::{Formulation, Load};
use toml::de::{DeTable, DeValue};

/// The table's name in messages.
pub(super) const ITEM: &str = "[solve]";

/// `[solve]` as far as it could be read; complete with [`SolveDraft::finish`].
#[derive(Debug, Default)]
pub(super) struct SolveDraft {
    settings: SolveSettings,
    file: Given,
    options: Given,
    poisson: PoissonDraft,
}

/// What the file gives, or the options do.
#[derive(Debug, Default)]
struct Given {
    formulation: Option<Formulation>,
    /// True where a formulation is given and could not be read.
    formulation_unread: bool,
    order: Option<usize>,
    star: Option<Star>,
    /// Keys that not every formulation knows, with their places.
    keys: Vec<(Key, Place)>,
    /// Where a tolerance is given.
    tolerance: Option<Place>,
    /// Where the most nodes on the way to it are.
    max_nodes: Option<Place>,
}

/// A `star`, which wants an order to be checked against.
#[derive(Clone, Debug)]
struct Star {
    n: i128,
    place: Place,
}

/// A key that not every formulation knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Key {
    Order,
    Star,
    Stars,
    Smoothing,
    Trial,
    Test,
    Gauss,
}

impl Key {
    fn name(self) -> &'static str {
        match self {
            Self::Order => "order",
            Self::Star => "star",
            Self::Stars => "stars",
            Self::Smoothing => "smoothing",
            Self::Trial => "trial",
            Self::Test => "test",
            Self::Gauss => "gauss",
        }
    }

    /// Why none of `used` knows the key, and what to do; `None` where one does.
    fn misplaced(self, used: &[Formulation]) -> Option<(String, &'static str)> {
        let key = self.name();
        match self {
            Self::Order | Self::Star | Self::Stars | Self::Smoothing => {
                let meshless = used.iter().any(|f| Formulation::MESHLESS.contains(f));
                let message = format!(
                    "`{key}` is given, and finite elements, which alone are used, are linear and have no stars"
                );
                (!meshless).then_some((message, "leave it out, or choose formulation = \"variational\" or \"local\""))
            }
            Self::Trial | Self::Test | Self::Gauss => {
                let message =
                    format!("`{key}` is given, and belongs to the variational formulation, which no subdomain has");
                let variational = used.contains(&Formulation::Variational);
                (!variational).then_some((message, "leave it out, or choose formulation = \"variational\""))
            }
        }
    }
}

/// The `[solve]` of the file, and the options over it.
pub(super) fn read(reader: &mut Reader<'_>, top: &Table<'_, '_>, options: &Overrides) -> SolveDraft {
    let mut draft = SolveDraft::default();
    if let Some(value) = top.get("solve") {
        match value.get_ref() {
            DeValue::Table(entries) => draft.read_file(reader, entries, value),
            _ => {
                let remedy = "write [solve] on a line of its own, with its keys below";
                reader.wrong_kind_with::<()>("", "solve", "a table", value, remedy);
            }
        }
    }
    draft.read_options(options, &mut reader.faults);
    draft
}

impl SolveDraft {
    fn read_file(&mut self, reader: &mut Reader<'_>, entries: &DeTable<'_>, value: &Value<'_>) {
        let table = Table { entries, place: value.span(), item: ITEM.to_owned() };
        reader.known_keys(&table, ITEM, SOLVE_KEYS);
        self.poisson.read_file(reader, &table);
        let Self { settings, file, .. } = self;
        let keys = [Key::Order, Key::Star, Key::Stars, Key::Smoothing, Key::Trial, Key::Test, Key::Gauss];
        let given = keys.into_iter().filter_map(|key| Some((key, Place::File(table.get(key.name())?.span()))));
        file.keys.extend(given);

        file.formulation = word(reader, &table, "formulation", "\"variational\"", limits::formulation);
        file.formulation_unread = file.formulation.is_none() && table.get("formulation").is_some();
        settings.formulation = file.formulation.unwrap_or_default();
        settings.holes = word(reader, &table, "holes", "\"circulation\"", limits::hole_condition).unwrap_or_default();
        settings.stars = word(reader, &table, "stars", "\"balanced\"", limits::stars);
        settings.trial = word(reader, &table, "trial", "\"blended\"", limits::trial).unwrap_or_default();
        settings.test = word(reader, &table, "test", "\"hat\"", limits::test).unwrap_or_default();
        settings.solver = word(reader, &table, "solver", "\"iterative\"", limits::solver).unwrap_or_default();
        let [twist, torque] = ["twist", "torque"].map(|key| {
            let value = table.get(key)?;
            reader.number(ITEM, key, value, "1.0", limits::load)
        });
        if table.get("twist").is_some() && table.get("torque").is_some() {
            let place = table.key_place("twist").start.max(table.key_place("torque").start);
            let place = if place == table.key_place("twist").start { "twist" } else { "torque" };
            let message = "both `twist` and `torque` are given, and each determines the other";
            reader.faults.push(table.key_place(place), ITEM, message, "keep one of them");
        }
        settings.load = twist.map(Load::Twist).or(torque.map(Load::Torque)).unwrap_or(settings.load);
        if let Some(value) = table.get("smoothing") {
            let g = reader.number(ITEM, "smoothing", value, "0.1", |_, value| limits::smoothing(value));
            settings.smoothing = g.unwrap_or_default();
        }
        file.order = table.get("order").and_then(|v| reader.whole(ITEM, "order", v, "2", limits::order));
        settings.order = file.order.unwrap_or(settings.order);
        if let Some(value) = table.get("star") {
            let n = reader.whole(ITEM, "star", value, "9", Ok);
            file.star = n.map(|n| Star { n, place: value.span().into() });
        }
        settings.gauss = table.get("gauss").and_then(|v| reader.whole(ITEM, "gauss", v, "3", limits::gauss));
        if let Some(seed) = table.get("seed").and_then(|v| reader.whole(ITEM, "seed", v, "1", limits::seed)) {
            settings.seed = seed;
        }
        if let Some(value) = table.get("estimate") {
            settings.estimate = reader.boolean(ITEM, "estimate", value).unwrap_or(settings.estimate);
        }
        if let Some(value) = table.get("tolerance") {
            settings.tolerance = reader.number(ITEM, "tolerance", value, "1e-4", |_, value| limits::tolerance(value));
            file.tolerance = Some(value.span().into());
        }
        if let Some(value) = table.get("max_nodes") {
            let most = reader.whole(ITEM, "max_nodes", value, "100000", limits::max_nodes);
            settings.max_nodes = most.unwrap_or(settings.max_nodes);
            file.max_nodes = Some(value.span().into());
        }
    }

    /// Puts the options of the command over the settings of the file.
    fn read_options(&mut self, options: &Overrides, faults: &mut Faults) {
        self.poisson.read_options(options, faults);
        let Self { settings, options: given, .. } = self;
        let place = |name: &str, value: &dyn std::fmt::Display| Place::Option(format!("--{name} {value}"));
        if let Some(word) = &options.formulation {
            given.formulation = option(faults, &place("formulation", word), limits::formulation(word));
            given.formulation_unread = given.formulation.is_none();
            settings.formulation = given.formulation.unwrap_or_default();
        }
        if let Some(word) = &options.holes {
            settings.holes = option(faults, &place("holes", word), limits::hole_condition(word)).unwrap_or_default();
        }
        if let (Some(twist), Some(torque)) = (options.twist, options.torque) {
            let place = Place::Option(format!("--twist {twist} --torque {torque}"));
            faults.push(place, "", "both are given, and each determines the other", "keep one of them");
        }
        let twist = options.twist.map(|value| (value, "twist", Load::Twist as fn(f64) -> Load));
        let torque = options.torque.map(|value| (value, "torque", Load::Torque as fn(f64) -> Load));
        for (value, name, load) in twist.into_iter().chain(torque) {
            if let Some(value) = option(faults, &place(name, &limits::show(value)), limits::load(name, value)) {
                settings.load = load(value);
            }
        }
        // Each option that not every formulation knows: its place is kept, to be told where none does.
        let mut known = |key: Key, value: &dyn std::fmt::Display| {
            let place = place(key.name(), value);
            given.keys.push((key, place.clone()));
            place
        };
        if let Some(order) = options.order {
            given.order = option(faults, &known(Key::Order, &order), limits::order(order.into()));
            settings.order = given.order.unwrap_or(settings.order);
        }
        if let Some(star) = options.star {
            given.star = Some(Star { n: star.into(), place: known(Key::Star, &star) });
        }
        if let Some(word) = &options.stars {
            settings.stars = option(faults, &known(Key::Stars, word), limits::stars(word));
        }
        if let Some(g) = options.smoothing {
            let place = known(Key::Smoothing, &limits::show(g));
            settings.smoothing = option(faults, &place, limits::smoothing(g)).unwrap_or_default();
        }
        if let Some(word) = &options.trial {
            settings.trial = option(faults, &known(Key::Trial, word), limits::trial(word)).unwrap_or_default();
        }
        if let Some(word) = &options.test {
            settings.test = option(faults, &known(Key::Test, word), limits::test(word)).unwrap_or_default();
        }
        if let Some(points) = options.gauss {
            settings.gauss = option(faults, &known(Key::Gauss, &points), limits::gauss(points.into()));
        }
        if let Some(word) = &options.solver {
            settings.solver = option(faults, &place("solver", word), limits::solver(word)).unwrap_or_default();
        }
        if let Some(seed) = options.seed {
            settings.seed = seed;
        }
        settings.estimate = options.estimate.unwrap_or(settings.estimate);
        if let Some(tolerance) = options.tolerance {
            let place = place("tolerance", &limits::show(tolerance));
            settings.tolerance = option(faults, &place, limits::tolerance(tolerance));
            given.tolerance = Some(place);
        }
        if let Some(most) = options.max_nodes {
            let place = place("max-nodes", &most);
            let most = option(faults, &place, limits::max_nodes(most.into()));
            settings.max_nodes = most.unwrap_or(settings.max_nodes);
            given.max_nodes = Some(place);
        }
    }

    /// The settings, after the checks that want the formulations of the subdomains (as the file has them).
    ///
    /// A key of the file belongs to the formulations of the file: `--formulation fem` may stand over a file with an
    /// `order`, which then has no use. An option must have a use.
    pub(super) fn finish(mut self, subdomains: &[SubdomainDraft], faults: &mut Faults) -> SolveSettings {
        self.settings.poisson = std::mem::take(&mut self.poisson).finish(subdomains, faults);
        self.check_tolerance(subdomains, faults);
        let unread = self.options.formulation_unread
            || self.file.formulation_unread
            || subdomains.iter().any(|subdomain| subdomain.formulation_unread);
        if unread || subdomains.is_empty() {
            self.check_star(faults);
            return self.settings;
        }
        let of_file: Vec<Formulation> =
            subdomains.iter().map(|s| s.formulation.or(self.file.formulation).unwrap_or_default()).collect();
        let used: Vec<Formulation> = of_file.iter().map(|f| self.options.formulation.unwrap_or(*f)).collect();
        for (given, used) in [(&self.file, &of_file), (&self.options, &used)] {
            for (key, place) in &given.keys {
                if let Some((message, remedy)) = key.misplaced(used) {
                    faults.push(place.clone(), item(place), message, remedy);
                }
            }
        }
        if Key::Star.misplaced(&used).is_none() {
            self.check_star(faults);
        }
        self.check_first_order(subdomains, &used, faults);
        self.settings
    }

    /// The star against the order, the file's also where an option stands over it.
    fn check_star(&mut self, faults: &mut Faults) {
        let mut check = |star: &Star, order: usize| {
            let checked = limits::star(star.n, order);
            let refused =
                |Refusal { message, remedy }| faults.push(star.place.clone(), item(&star.place), message, remedy);
            checked.map_err(refused).ok()
        };
        if let (Some(replaced), Some(_)) = (&self.file.star, &self.options.star) {
            check(replaced, self.file.order.unwrap_or(SolveSettings::default().order));
        }
        if let Some(star) = self.options.star.as_ref().or(self.file.star.as_ref()) {
            self.settings.star = check(star, self.settings.order);
            self.settings.star_place = Some(star.place.clone());
        }
    }

    /// A tolerance wants an estimate, and clouds that may be graded.
    fn check_tolerance(&self, subdomains: &[SubdomainDraft], faults: &mut Faults) {
        let Some(place) = self.options.tolerance.as_ref().or(self.file.tolerance.as_ref()) else {
            if let Some(place) = self.options.max_nodes.as_ref().or(self.file.max_nodes.as_ref()) {
                let message = "`max_nodes` is given, and belongs to a `tolerance`, which is not";
                faults.push(
                    place.clone(),
                    item(place),
                    message,
                    "give tolerance = 1e-4 (--tolerance) too, or leave it out",
                );
            }
            return;
        };
        let mut refuse = |message: String, remedy: &str| faults.push(place.clone(), item(place), message, remedy);
        if !self.settings.estimate {
            refuse(
                "`tolerance` is given, and no error is estimated".into(),
                "leave `estimate = false` (--no-estimate) out",
            );
        }
        for subdomain in subdomains {
            let uniform = [
                (subdomain.division == Division::Chord, "division = \"chord\""),
                (subdomain.clearance == ClearanceUnit::Scaled, "clearance = \"scaled\""),
            ];
            for (_, written) in uniform.iter().filter(|(given, _)| *given) {
                let message = format!(
                    "`tolerance` is given, which makes clouds graded, and {written} of {} belongs to uniform ones",
                    subdomain.item
                );
                refuse(message, "leave one of the two out");
            }
        }
    }

    /// A plane has no second derivatives: the local equations need order 2.
    fn check_first_order(&self, subdomains: &[SubdomainDraft], used: &[Formulation], faults: &mut Faults) {
        let local = subdomains.iter().zip(used).find(|(_, f)| **f == Formulation::Local);
        let (1, Some((subdomain, _))) = (self.settings.order, local) else { return };
        let places = self.options.keys.iter().chain(&self.file.keys);
        let Some((_, place)) = places.clone().find(|(key, _)| *key == Key::Order) else { return };
        let message = format!("`order` is 1, and the local formulation of {} needs second derivatives", subdomain.item);
        let remedy = "give order = 2, 3 or 4, or choose formulation = \"variational\"";
        faults.push(place.clone(), item(place), message, remedy);
    }
}

/// The choice behind a word of the table.
fn word<T>(
    reader: &mut Reader<'_>,
    table: &Table<'_, '_>,
    key: &str,
    example: &str,
    check: fn(&str) -> Result<T, Refusal>,
) -> Option<T> {
    table.get(key).and_then(|value| reader.text(ITEM, key, value, example, check))
}

/// The table of a place in the file; an option names itself.
pub(super) fn item(place: &Place) -> &'static str {
    match place {
        Place::File(_) => ITEM,
        Place::Option(_) => "",
    }
}
