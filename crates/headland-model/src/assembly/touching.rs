//! Rolling without slipping on a curved ground: the place of contact has coordinates of its own, which have no inertia.
//!
//! Point P and unit normal n of the ground there, towards what rolls; c and w of what rolls relative to the ground; all in
//! the axes of the ground's frame. p(n) is the place of the body, from c, at which its outward normal is −n:
//!
//! ```text
//! z = f(s, t):       P = (s, t, f),   n = (−f_s, −f_t, 1)/√(1 + f_s² + f_t²)       coordinates s, t
//! d(P) = 0:          n = ∇d                                                        coordinates x, y, z of P
//! contact:           c + p(n) − P = 0
//! no slip:           c′ + w × p = 0,    rate: c″ + w′ × p + w × p′
//! ```
//! p is a place: it moves in the body and on the ground, and p′ is its rate, not `w × p`. Along n the second row is the
//! rate of the first, so a surface by its height needs its x and y only; of three coordinates the row `d = 0` says
//! nothing to velocities, for `n·P′ = 0` follows from the others.
//!
//! What touches in one point only is more curved than the ground: with `dp = −B dn`, `dn = H dP` along the tangents,
//! `1 + B H` has positive eigenvalues. The smaller one is watched.

use headland_expr::{Dual, Expr, NodeId, Scalar};
use headland_spatial::{Rotation, Vector};
use headland_surface::{Shape, Side};

use super::closures::{Relative, Row};
use super::number;
use super::rolling::{Form, RowForce, unit};
use super::surfaces::{Ground, Kind};
use crate::build::{Builder, Made, bound_name};
use crate::depend::Kinds;
use crate::dimension::Dimension;
use crate::lower::Reported;
use crate::model::{Guard, KinematicRow, RowForm};
use crate::scene::Data;
use crate::scene::Element as SceneElement;
use crate::symbols::{Binding, Members, Symbol};

/// A quantity with its first and second rate.
type Second<'g> = Dual<Dual<Expr<'g>>>;

/// Coordinates of the place of contact on a surface given by its height: `name.s` and `name.t`.
const ON_HEIGHT: &[&str] = &["s", "t"];
/// .. on a surface given by its distance: `name.x`, `name.y`, `name.z`.
const ON_SHAPE: &[&str] = &["x", "y", "z"];

/// Least value of 1 − radius of the body/radius of the ground: nearer to zero the place of contact runs without bounds.
pub(super) const ONE_POINT: f64 = 1e-2;

/// Sine of the angle between a disc's axis and the normal below which it lies flat.
const FLAT: f64 = 1e-7;

/// A curved ground.
pub(super) enum Curved<'g> {
    /// `z` by the coordinates of the place of contact.
    Height(Expr<'g>),
    /// By its distance.
    Distance(Ground<'g>),
}

/// The ground at the place of contact.
struct Patch<'g> {
    /// Positions of the coordinates.
    places: Vec<usize>,
    point: [Row<'g>; 3],
    normal: [Row<'g>; 3],
    /// How the normal changes with x, y, z of the point.
    turns: [Vector<Expr<'g>>; 3],
    /// Distance of the point from the surface, with its rates.
    distance: Option<Row<'g>>,
}

/// A place of contact whose coordinates may have to be guessed.
pub(crate) struct Touch<'g> {
    places: Vec<usize>,
    centre: Vector<Expr<'g>>,
    /// The place of the body, by the normal where the coordinates are.
    touching: Vector<Expr<'g>>,
    normal: Vector<Expr<'g>>,
    point: Vector<Expr<'g>>,
    distance: Option<Expr<'g>>,
}

impl<'g> Builder<'_, 'g> {
    /// Declares the coordinates of the places of contact.
    pub(super) fn declare_places(&mut self) {
        for element in self.scene.section_elements("rolling") {
            let Ok(name) = self.text_field(element, "name") else { continue };
            for binding in self.bindings_of(element).unwrap_or_default() {
                let Ok(ground) = self.frame_field(element, "on", &binding, Some(0)) else { break };
                for part in self.place_parts(element, ground) {
                    let _ = self.declare_place(element, &bound_name(&name, &binding), part);
                }
            }
        }
    }

    fn declare_place(&mut self, element: &SceneElement, full: &str, part: &str) -> Made<()> {
        let (base, member) = self.split_name(full, &element.place)?;
        let family = format!("{base}.{part}");
        let position =
            self.low.add_coordinate(format!("{full}.{part}"), &Dimension::of(0, 1, 0), false, &element.place);
        self.low.coordinates[position].guess = Some(0.0);
        match self.low.symbols.by_name.get_mut(family.as_str()) {
            Some(Symbol::Coordinate(members)) => {
                members.insert(member, position);
            }
            _ => {
                let members = Members::family([(member, position)]);
                self.low.symbols.by_name.insert(family.as_str().into(), Symbol::Coordinate(members));
            }
        }
        Ok(())
    }

    /// The curved ground on which a form rolls by a place of contact; none for planes, and for balls on shapes whose
    /// distance from the centre says all.
    pub(super) fn curved_place(
        &mut self,
        name: &str,
        form: &Form<Expr<'g>>,
        element: &SceneElement,
        ground: usize,
        binding: &Binding,
    ) -> Made<Option<Curved<'g>>> {
        let length = Dimension::of(0, 1, 0);
        if is(element, "height") {
            let Some(height) = self.scalar_field(element, "height", binding, &length)? else {
                let message = format!(
                    "`surface = \"height\"` needs `height`: z by `{name}.s` and `{name}.t`, the place of contact"
                );
                return Err(self.low.report(element.place.clone(), message));
            };
            self.made_of_places(name, element, height)?;
            return Ok(Some(Curved::Height(height)));
        }
        if self.place_parts(element, ground).is_empty() {
            return Ok(None);
        }
        let shape = self.ground_shape(element, ground, binding)?;
        self.must_be_smooth(&shape, "rolling without slipping", element)?;
        if let Ground::Field(_, Kind::Height(height)) = &shape {
            let places = self.places_of(name, ON_HEIGHT)?;
            let at = [0, 1].map(|k| self.coordinate(places[k])[0]);
            return Ok(Some(Curved::Height(height.with(self.low.graph, at))));
        }
        if let Ground::Shape(Shape::Sphere { radius, side: Side::Inside }) = shape
            && let (Some(hollow), Some(body)) = (self.evaluate(radius), form.reach().and_then(|r| self.evaluate(r)))
            && body >= hollow
        {
            let message = format!(
                "what rolls has a radius of {body} m and does not fit into a sphere of {hollow} m: it must be smaller"
            );
            return Err(self.low.report(element.place.clone(), message));
        }
        Ok(Some(Curved::Distance(shape)))
    }

    /// The coordinates that a place of contact has; a ball on a plane or shape has none.
    fn place_parts(&self, element: &SceneElement, ground: usize) -> &'static [&'static str] {
        let frame = &self.assembly.frames[ground];
        let of_surface = frame.element.as_ref().filter(|_| frame.is_surface).and_then(|(e, _)| e.get("shape"));
        let curved = match of_surface.map(|v| &v.data) {
            Some(Data::Text(word)) if word == "height" => return ON_HEIGHT,
            Some(Data::Text(word)) => word != "plane",
            _ => is(element, "sphere") || is(element, "cylinder"),
        };
        let is_ball = ["axis", "semi_axes"].iter().all(|k| element.get(k).is_none());
        match (is(element, "height"), curved && !is_ball) {
            (true, _) => ON_HEIGHT,
            (_, true) => ON_SHAPE,
            _ => &[],
        }
    }

    /// A height is a function of the place of contact: what moves is the frame on which it stands.
    fn made_of_places(&mut self, name: &str, element: &SceneElement, height: Expr<'g>) -> Made<()> {
        let graph = self.low.graph;
        let own: Vec<usize> =
            self.places_of(name, ON_HEIGHT)?.iter().map(|&i| self.input_of(self.low.coordinates[i].q)).collect();
        // not zero, which would take factors with it
        let rest = graph.substitute(&[graph.id(height)], |i| own.contains(&i).then_some(number(0.731)))[0];
        let Some(input) = self.depends(rest, Kinds::PARAMETER.not()) else { return Ok(()) };
        let place = element.get("height").map_or(element.place.clone(), |v| v.place.clone());
        let message = format!(
            "`height` depends on `{input}`; it is made of `{name}.s`, `{name}.t` and parameters (a ground that moves is a \
             body or frame: `on`)"
        );
        Err(self.low.report(place, message))
    }

    /// The slot of an input.
    pub(super) fn input_of(&self, input: NodeId) -> usize {
        self.low.graph.node(input).args[0] as usize
    }

    fn places_of(&self, name: &str, parts: &[&str]) -> Made<Vec<usize>> {
        let found = |part: &&str| self.low.coordinates.iter().position(|c| c.name == format!("{name}.{part}"));
        parts.iter().map(found).collect::<Option<Vec<usize>>>().ok_or(Reported)
    }

    fn with_rates(&mut self, e: Expr<'g>, element: &SceneElement) -> Made<Row<'g>> {
        let mut rate =
            |e: Expr<'g>| self.low.time_derivative(e, 1).map_err(|m| self.low.report(element.place.clone(), m));
        let first = rate(e)?;
        Ok([e, first, rate(first)?])
    }

    fn coordinate(&self, i: usize) -> Row<'g> {
        let c = &self.low.coordinates[i];
        [c.q, c.rate, c.acceleration].map(|n| self.low.graph.expr(n))
    }

    fn patch(&mut self, name: &str, ground: &Curved<'g>, element: &SceneElement) -> Made<Patch<'g>> {
        let graph = self.low.graph;
        match ground {
            Curved::Height(height) => {
                let places = self.places_of(name, ON_HEIGHT)?;
                let slots = [0, 1].map(|k| self.input_of(self.low.coordinates[places[k]].q));
                let by = |slot: usize, nodes: &[NodeId]| graph.tangent(nodes, |i| (i == slot).then_some(number(1.0)));
                let [f_s, f_t] = slots.map(|slot| by(slot, &[graph.id(*height)])[0]);
                let n = Vector([-f_s, -f_t, number(1.0)]).unit();
                let nodes = n.0.map(|e| graph.id(e));
                let [n_s, n_t] = slots.map(|slot| by(slot, &nodes)).map(|v| Vector([v[0], v[1], v[2]]));
                let point =
                    [self.coordinate(places[0]), self.coordinate(places[1]), self.with_rates(*height, element)?];
                let normal = self.vector_with_rates(n, element)?;
                Ok(Patch { places, point, normal, turns: [n_s, n_t, Vector::zero()], distance: None })
            }
            Curved::Distance(shape) => {
                let places = self.places_of(name, ON_SHAPE)?;
                let point = [0, 1, 2].map(|k| self.coordinate(places[k]));
                let [p, p_rate, p_second] = [0, 1, 2].map(|order| Vector(point.map(|row| row[order])));
                let n = shape.normal(p);
                let n_rate = shape.normal_rate(p, p_rate);
                let mut normal = [[number(0.0); 3]; 3];
                for (i, row) in normal.iter_mut().enumerate() {
                    let second = self.low.time_derivative(n_rate[i], 1);
                    let second = second.map_err(|m| self.low.report(element.place.clone(), m))?;
                    *row = [n[i], n_rate[i], second];
                }
                let distance = Some([shape.distance(p), n.dot(p_rate), n_rate.dot(p_rate) + n.dot(p_second)]);
                let turns = [0, 1, 2].map(|k| shape.normal_rate(p, unit(k)));
                Ok(Patch { places, point, normal, turns, distance })
            }
        }
    }

    fn vector_with_rates(&mut self, v: Vector<Expr<'g>>, element: &SceneElement) -> Made<[Row<'g>; 3]> {
        let [x, y, z] = v.0;
        Ok([self.with_rates(x, element)?, self.with_rates(y, element)?, self.with_rates(z, element)?])
    }

    /// The rows of what rolls on a curved ground, its forces, and the limit of its touching in one point.
    pub(super) fn roll_by_place(
        &mut self,
        name: &str,
        relative: &Relative<'g>,
        form: &Form<Expr<'g>>,
        ground: &Curved<'g>,
        element: &SceneElement,
    ) -> Made<()> {
        let patch = self.patch(name, ground, element)?;
        let turning = Rotation([0, 1, 2].map(|i| [0, 1, 2].map(|k| second(relative.rotation(i, k)))));
        let normal = Vector(patch.normal.map(second));
        let p = form.map(fixed).touching(&turning, normal);
        let graph = self.low.graph;
        let n = Vector(patch.normal.map(|row| row[0]));
        let heading = form.heading_on(&relative.turning(), n);
        let [h, e] = heading.unwrap_or([0, 1].map(unit));
        let along = |row, i: usize| RowForce { row, ground: unit(i), wheel: Vector([h[i], e[i], n[i]]) };
        let mut forces = Vec::new();
        for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let gap = rates(second(relative.distance(i)) + p[i] - second(patch.point[i]));
            let row = self.hold(&format!("{name}.contact {axis}"), gap, &element.place);
            forces.extend(row.map(|row| along(row, i)));
        }
        let slip = relative.slip_at(p.map(|e| e.value.value), p.map(|e| e.dot.value));
        let count = if patch.distance.is_some() { 3 } else { 2 };
        for (i, axis) in ["x", "y", "z"].into_iter().enumerate().take(count) {
            let row = self.bind_velocity(&format!("{name}.{axis}"), slip[i], "", element);
            forces.extend(row.map(|row| along(row, i)));
        }
        if let Some([distance, ..]) = patch.distance {
            let zero = graph.id(number(0.0));
            let row = KinematicRow::new(format!("{name}.surface"), &element.place, RowForm::Zero(zero));
            let row =
                KinematicRow { position: Some(graph.id(distance)), rate: Some(zero), may_be_redundant: true, ..row };
            self.parts.kinematics.push(row);
        }
        self.must_not_lie_flat(name, form, &relative.turning(), n, element);
        self.name_contact_forces(name, heading.is_some(), forces);
        self.watch_curvature(name, &relative.turning(), form, n, &patch.turns);
        self.assembly.touches.push(Touch {
            places: patch.places,
            centre: Vector([0, 1, 2].map(|i| relative.distance(i)[0])),
            touching: Vector([0, 1, 2].map(|i| relative.distance(i)[0] + p[i].value.value)),
            normal: n,
            point: Vector(patch.point.map(|row| row[0])),
            distance: patch.distance.map(|row| row[0]),
        });
        Ok(())
    }

    /// A disc that lies flat at the start is told of there.
    pub(super) fn must_not_lie_flat(
        &mut self,
        name: &str,
        form: &Form<Expr<'g>>,
        turning: &Rotation<Expr<'g>>,
        n: Vector<Expr<'g>>,
        element: &SceneElement,
    ) {
        if let Form::Disc { axis, .. } = form {
            let sine = turning.apply(*axis).cross(n).norm();
            self.assembly.tilts.push((name.into(), element.place.clone(), self.low.graph.id(sine)));
        }
    }

    /// `1 + B H` must not lose rank: the smaller of its eigenvalues on the tangent plane stays positive.
    fn watch_curvature(
        &mut self,
        name: &str,
        turning: &Rotation<Expr<'g>>,
        form: &Form<Expr<'g>>,
        n: Vector<Expr<'g>>,
        turns: &[Vector<Expr<'g>>; 3],
    ) {
        // columns of B H (1 − n nᵀ)
        let along = |v: Vector<Expr<'g>>| turns[0] * v[0] + turns[1] * v[1] + turns[2] * v[2];
        let columns = [0, 1, 2].map(|k| form.flattened(turning, n, along(unit(k) - n * n[k])));
        let trace = columns[0][0] + columns[1][1] + columns[2][2];
        let mut square = number(0.0);
        for i in 0..3 {
            for k in 0..3 {
                square = square + columns[i][k] * columns[k][i];
            }
        }
        // half the difference of the two eigenvalues of B H, squared
        let spread = number(0.5) * square - number(0.25) * trace * trace;
        let least = number(1.0) + number(0.5) * trace - spread.max(number(0.0)).sqrt();
        if least.value().is_some_and(|x| x > 0.0) {
            return;
        }
        self.parts.guards.push(Guard {
            name: format!("{name}.clearance"),
            quantity: self.low.graph.id(least),
            unit: String::new(),
            warn_below: None,
            stop_below: Some(ONE_POINT),
            message: format!(
                "what rolls by `{name}` is hardly more curved there than the ground, or less (this is 1 - radius of the \
                 body/radius of the ground): it would touch in more than one place"
            ),
        });
    }

    /// Coordinates of places of contact that were not given: the point of the ground nearest to what rolls, at the start.
    pub(crate) fn guess_places(&mut self) {
        let touches = std::mem::take(&mut self.assembly.touches);
        let tilts = std::mem::take(&mut self.assembly.tilts);
        if (touches.is_empty() && tilts.is_empty()) || !self.low.diagnostics.is_empty() {
            return;
        }
        let mut inputs = self.start_inputs();
        for touch in &touches {
            // just below the centre; that of a cylinder is no place to begin, whatever the height
            let beside = [[0.0, 0.0, -1e-3], [1e-3, 2e-3, 0.0]];
            let found = beside.iter().find_map(|beside| self.nearest(touch, &mut inputs, beside));
            if let Some(found) = found {
                for (&i, x) in touch.places.iter().zip(found) {
                    self.low.coordinates[i].guess = Some(x);
                }
            }
        }
        for (name, place, tilt) in tilts {
            let sine = self.low.graph.eval(&[tilt], &inputs)[0];
            if sine < FLAT {
                let message = format!(
                    "the wheel or disc of `{name}` lies flat at the start (its axis is along the normal of the ground): it \
                     has no single point of contact; another `axis`, or an orientation under [initial], stands it up"
                );
                let _ = self.low.report(place, message);
            }
        }
    }

    /// All inputs as they are at the start: parameters, time, coordinates as given or guessed.
    fn start_inputs(&self) -> Vec<f64> {
        let graph = self.low.graph;
        let mut inputs = vec![0.0; graph.input_count()];
        self.parts.parameters.iter().for_each(|p| inputs[p.input] = p.value);
        inputs[self.input_of(self.low.time)] = self.parts.run.as_ref().map_or(0.0, |r| r.from);
        for c in &self.low.coordinates {
            inputs[self.input_of(c.q)] = c.guess.unwrap_or(0.0);
        }
        for c in &self.low.coordinates {
            if let Some(initial) = c.initial {
                inputs[self.input_of(c.q)] = graph.eval(&[initial], &inputs)[0];
            }
        }
        inputs
    }

    /// The point of the ground goes along it to below the place of the body for its normal, by shorter steps where that goes
    /// too far: a body that is flatter than the ground moves its place by more than the point.
    fn nearest(&self, touch: &Touch<'g>, inputs: &mut [f64], beside: &[f64; 3]) -> Option<Vec<f64>> {
        let graph = self.low.graph;
        let ids = |v: Vector<Expr<'g>>| v.0.map(|e| graph.id(e));
        let centre = graph.eval(&ids(touch.centre), inputs);
        let (mut place, mut toward) = self.miss(touch, inputs, [0, 1, 2].map(|k| centre[k] + beside[k]))?;
        let mut step = 1.0;
        for _ in 0..500 {
            let trial = [0, 1, 2].map(|k| place[k] + step * toward[k]);
            match self.miss(touch, inputs, trial) {
                Some((next, miss)) if miss.norm() < toward.norm() => (place, toward) = (next, miss),
                _ if step < 1e-3 => break,
                _ => step *= 0.5,
            }
        }
        let (place, _) = self.miss(touch, inputs, place)?;
        Some(place[..touch.places.len()].to_vec())
    }

    /// The point of the ground at a place, and from there to the place of the body that its normal belongs to, along the
    /// ground.
    fn miss(&self, touch: &Touch<'g>, inputs: &mut [f64], mut place: [f64; 3]) -> Option<([f64; 3], Vector<f64>)> {
        let graph = self.low.graph;
        let ids = |v: Vector<Expr<'g>>| v.0.map(|e| graph.id(e));
        let set = |inputs: &mut [f64], place: &[f64; 3]| {
            for (&i, x) in touch.places.iter().zip(place) {
                inputs[self.input_of(self.low.coordinates[i].q)] = *x;
            }
        };
        set(inputs, &place);
        if let Some(distance) = touch.distance {
            let d = graph.eval(&[graph.id(distance)], inputs)[0];
            let n = graph.eval(&ids(touch.normal), inputs);
            place = [0, 1, 2].map(|k| place[k] - d * n[k]);
            set(inputs, &place);
        }
        let vector = |v: Vector<Expr<'g>>| {
            let x = graph.eval(&ids(v), inputs);
            Vector([x[0], x[1], x[2]])
        };
        let (n, at) = (vector(touch.normal), vector(touch.point));
        let miss = vector(touch.touching) - at;
        let miss = miss - n * n.dot(miss);
        let is_finite = at.0.iter().chain(&miss.0).all(|x| x.is_finite());
        is_finite.then_some((at.0, miss))
    }
}

fn is(element: &SceneElement, surface: &str) -> bool {
    matches!(element.get("surface"), Some(v) if v.data == Data::Text(surface.into()))
}

fn second([value, rate, second]: Row<'_>) -> Second<'_> {
    Dual::new(Dual::new(value, rate), Dual::new(rate, second))
}

fn fixed(e: Expr<'_>) -> Second<'_> {
    second([e, number(0.0), number(0.0)])
}

fn rates(e: Second<'_>) -> Row<'_> {
    [e.value.value, e.value.dot, e.dot.dot]
}
