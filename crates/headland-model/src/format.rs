//! The scene format, one row a section and a key: read by the reader, the checks, the JSON Schema and the manual.

use serde_json::{Map, Value, json};

use crate::scene::Data;

/// How a section is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// `key = …` at the top of the file.
    Top,
    /// `[section]`, the keys are the scene's own names.
    Names,
    /// `[section]`, the keys are fixed.
    Keys,
    /// `[[section]]`, once an element.
    Elements,
}

/// What a key takes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// A text.
    Text,
    /// A number, a quantity with a unit, or an expression.
    Expression,
    /// An expression, or an array of them.
    Expressions,
    /// A list of texts.
    Texts,
    /// true or false.
    Flag,
    /// A unit.
    Unit,
    /// A table `{ x = [..], y = [..] }`.
    Points,
}

impl Kind {
    /// Whether a value can be meant.
    pub fn admits(self, data: &Data) -> bool {
        match (self, data) {
            (Kind::Text | Kind::Unit, Data::Text(_)) | (Kind::Flag, Data::Flag(_)) => true,
            (Kind::Expression | Kind::Expressions, Data::Number(_) | Data::Text(_)) => true,
            (Kind::Expressions, Data::Array(_)) | (Kind::Points, Data::Table(_)) => true,
            (Kind::Texts, Data::Array(values)) => values.iter().all(|v| matches!(v.data, Data::Text(_))),
            _ => false,
        }
    }

    /// What it is, for messages.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Text => "a text",
            Kind::Unit => "a unit",
            Kind::Flag => "true or false",
            Kind::Expression => "a number, a quantity or an expression",
            Kind::Expressions => "a number, a quantity, an expression or an array",
            Kind::Texts => "a list of texts",
            Kind::Points => "a table",
        }
    }
}

/// One key of a section.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// True if it must be there.
    pub required: bool,
    /// What it means.
    pub doc: &'static str,
}

/// One section of the file.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Its name.
    pub name: &'static str,
    /// How it is written.
    pub shape: Shape,
    /// What the values of a section of names are.
    pub kind: Kind,
    /// Its keys, where they are fixed.
    pub keys: &'static [Key],
    /// What it is for.
    pub doc: &'static str,
}

const fn key(name: &'static str, kind: Kind, required: bool, doc: &'static str) -> Key {
    Key { name, kind, required, doc }
}

const fn names(name: &'static str, kind: Kind, doc: &'static str) -> Section {
    Section { name, shape: Shape::Names, kind, keys: &[], doc }
}

const fn elements(name: &'static str, keys: &'static [Key], doc: &'static str) -> Section {
    Section { name, shape: Shape::Elements, kind: Kind::Text, keys, doc }
}

const NAME: Key = key("name", Kind::Text, true, "name, with an index for a family: `mass[k]`");
const GEOMETRIC: Key = key("geometric", Kind::Expression, false, "structure d(q, t): a coordinate of the element");
const IMPLICIT: Key =
    key("implicit", Kind::Expression, false, "structure d'(q, q', t): its rate by the coordinates' rates");
const EXPLICIT: Key =
    key("explicit", Kind::Expression, false, "structure d'(q, u, t): its rate by the quasi-velocities");

const POSITION: Key =
    key("position", Kind::Expressions, false, "structure: a point in the world, [x, y, z] by q and t");
const VELOCITY: Key = key("velocity", Kind::Expressions, false, "structure: its velocity in the world, by q' or u");
const SPIN: Key = key("spin", Kind::Expressions, false, "structure: angular velocity in body axes, by q' or u");
const FROM: Key = key("from", Kind::Text, false, "a body or frame; `world` by default");
const TO: Key = key("to", Kind::Text, true, "a body or frame");
const AT: Key = key("at", Kind::Expressions, false, "place on `from`, [x, y, z]; its origin by default");
const TO_AT: Key = key("to_at", Kind::Expressions, false, "place on `to`, [x, y, z]; its origin by default");
const RPY: Key = key("rpy", Kind::Expressions, false, "orientation [roll, pitch, yaw]: Rz(yaw) Ry(pitch) Rx(roll)");

/// The sections, in the order of the manual.
pub const SECTIONS: &[Section] = &[
    Section { name: "title", shape: Shape::Top, kind: Kind::Text, keys: &[], doc: "what the scene is, in a line" },
    Section {
        name: "description",
        shape: Shape::Top,
        kind: Kind::Text,
        keys: &[],
        doc: "more about it: source, conventions",
    },
    names("indices", Kind::Expression, "index = number of members: `k = \"len(l)\"`; members count from 1"),
    names(
        "parameters",
        Kind::Expressions,
        "numbers (`4`), quantities (`\"4 m\"`), arrays of them, or expressions of other parameters; all can be set from outside",
    ),
    names(
        "tables",
        Kind::Points,
        "functions by points, `mu = { x = [..], y = [..], x_unit = \"m\", y_unit = \"1\" }`, used as `mu(x)`: natural cubic spline; with `z = [[..], ..]` or a `file` of lines `x, y, z` of two variables, used as `ground(x, y)`",
    ),
    names("coordinates", Kind::Unit, "generalised coordinates q and their units: `\"theta[k]\" = \"rad\"`"),
    names(
        "quasi_velocities",
        Kind::Unit,
        "quasi-velocities u and their units; without them the independent rates serve",
    ),
    names("prescribed", Kind::Expression, "coordinates that are given functions of the time t"),
    names(
        "definitions",
        Kind::Expression,
        "named intermediate expressions; `\"psi[k+1]\"` from `psi[k]` is a recurrence",
    ),
    names("kinematics", Kind::Expression, "form (2): `\"x'\" = ..` by quasi-velocities, coordinates and time"),
    elements(
        "constraint",
        &[
            NAME,
            key(
                "equation",
                Kind::Text,
                true,
                "linear in the rates, `x'*sin(theta) = y'*cos(theta)`, or of positions, `x^2 + y^2 = l^2`",
            ),
        ],
        "constraints on velocities, form (1), or on positions: the program solves them for the dependent rates",
    ),
    Section {
        name: "world",
        shape: Shape::Keys,
        kind: Kind::Text,
        keys: &[key("gravity", Kind::Expressions, false, "acceleration of free fall, [x, y, z]; none by default")],
        doc: "what acts on all bodies",
    },
    elements(
        "body",
        &[
            NAME,
            key("mass", Kind::Expression, false, "mass; none by default"),
            key(
                "center",
                Kind::Expressions,
                false,
                "mass centre in the body's frame, [x, y, z]; its origin by default",
            ),
            key(
                "inertia",
                Kind::Expressions,
                false,
                "tensor about the mass centre, axes of the body: [xx, yy, zz] or [xx, yy, zz, xy, xz, yz], entries of the matrix",
            ),
            key(
                "shape",
                Kind::Text,
                false,
                "instead of `inertia`: box, cylinder, sphere, spherical shell, rod, disc, ring, ellipsoid",
            ),
            key("size", Kind::Expressions, false, "of the shape: edges; radius and length; radius; length; semi-axes"),
            key("axis", Kind::Expressions, false, "of the shape: \"x\", \"y\" or \"z\" (default)"),
            key(
                "angular_velocity",
                Kind::Text,
                false,
                "of a free body, the axes of its quasi-velocities: `body` (default: NAME.wx ..) or `world` (NAME.omega_x ..)",
            ),
        ],
        "rigid bodies; one on which no joint acts is free",
    ),
    elements(
        "frame",
        &[NAME, key("on", Kind::Text, false, "the body or frame to which it is fixed; `world` by default"), AT, RPY],
        "frames fixed to bodies, for joints, forces and outputs",
    ),
    elements(
        "joint",
        &[
            NAME,
            key(
                "kind",
                Kind::Text,
                true,
                "weld, revolute, prismatic, screw, cylindrical, universal, planar, spherical, free",
            ),
            FROM,
            TO,
            AT,
            RPY,
            TO_AT,
            key("to_rpy", Kind::Expressions, false, "orientation of the joint on `to`"),
            key(
                "axis",
                Kind::Expressions,
                false,
                "of a revolute, prismatic, screw or cylindrical joint, in its frame: \"x\", \"y\", \"z\" (default) or [x, y, z]",
            ),
            key("lead", Kind::Expression, false, "of a screw: advance a turn"),
            key("orientation", Kind::Text, false, "of a spherical or free joint: `quaternion` (default) or `rpy`"),
            key("cut", Kind::Flag, false, "true: this joint closes a loop"),
        ],
        "joints; their coordinates are named after them. What is over in a tree closes loops",
    ),
    elements(
        "surface",
        &[
            NAME,
            key("on", Kind::Text, false, "the body or frame to which it is fixed; `world` by default"),
            AT,
            RPY,
            key(
                "shape",
                Kind::Text,
                true,
                "plane z = 0, sphere, cylinder, cone, torus, ellipsoid, revolution, height, mesh",
            ),
            key("radius", Kind::Expression, false, "of a sphere or cylinder; of a torus to the middle of its tube"),
            key("tube", Kind::Expression, false, "of a torus: radius of its tube"),
            key(
                "half_angle",
                Kind::Expression,
                false,
                "of a cone: between its axis z and its side; its tip is the origin",
            ),
            key("semi_axes", Kind::Expressions, false, "of an ellipsoid, along x, y and z"),
            key(
                "profile",
                Kind::Expression,
                false,
                "of a surface of revolution about z: its height by `r`, or its radius by `z`",
            ),
            key("range", Kind::Expressions, false, "of a surface of revolution: [from, to] of `r` or `z`"),
            key("height", Kind::Expression, false, "of a surface by its height: z by `x` and `y` of its frame"),
            key("inside", Kind::Flag, false, "true: a recess, what touches it is inside; outside by default"),
            key("file", Kind::Text, false, "of a mesh: a Wavefront OBJ or STL file, from the scene's folder"),
            key("table", Kind::Text, false, "of a mesh: the table of two variables whose points are its corners"),
            key("density", Kind::Expression, false, "of a mesh with `radius`: 20 density^2 triangles make a sphere"),
            key("open", Kind::Flag, false, "of a mesh: true allows one that is not closed"),
            key("smooth", Kind::Flag, false, "of a mesh: true interpolates normals between its corners"),
        ],
        "surfaces that bodies roll on or touch; each is a frame, too",
    ),
    elements(
        "contact",
        &[
            NAME,
            key("body", Kind::Text, true, "the body or frame with the ball that touches"),
            key("on", Kind::Text, false, "a surface, or a frame for its plane z = 0; `world` by default"),
            key("center", Kind::Expressions, false, "centre of the ball in `body`"),
            key("radius", Kind::Expression, false, "of the ball; 0 by default: a point"),
            key(
                "friction",
                Kind::Expression,
                false,
                "coefficient while sliding, by parameters and `NAME.slip`; none by default: it never slips",
            ),
            key(
                "static_friction",
                Kind::Expression,
                false,
                "coefficient up to which it rolls; `friction` at no slip by default",
            ),
            key("viscous_friction", Kind::Expression, false, "friction by normal force and slip speed, s/m"),
            key("restitution", Kind::Expression, false, "normal speed after an impact by that before; 0 by default"),
            key("start", Kind::Text, false, "`auto` (default: by place and slip), `rolling`, `sliding` or `free`"),
            key(
                "stiffness",
                Kind::Expression,
                false,
                "k of the normal force k d^n: the contact is compliant, not hard",
            ),
            key("exponent", Kind::Expression, false, "n; 1 by default: linear; 1.5 after Hertz"),
            key(
                "damping",
                Kind::Expression,
                false,
                "c of the factor 1 + c d' after Hunt and Crossley, s/m; 0 by default",
            ),
            key("slip_speed", Kind::Expression, false, "over which friction is rounded off; 1 mm/s by default"),
            key("stribeck_speed", Kind::Expression, false, "over which `static_friction` falls to `friction`"),
            key("rolling_resistance", Kind::Expression, false, "torque against rolling by normal force, a length"),
            key("spinning_resistance", Kind::Expression, false, "torque against spinning by normal force, a length"),
        ],
        "contact of a ball with a surface, hard or (with `stiffness`) compliant: it rolls, slides, leaves, bounces",
    ),
    elements(
        "rolling",
        &[
            NAME,
            key("body", Kind::Text, true, "the body or frame that rolls"),
            key("on", Kind::Text, false, "a surface, or a body or frame for its plane z = 0; `world` by default"),
            key("center", Kind::Expressions, false, "centre of the wheel, ball or ellipsoid in `body`"),
            RPY,
            key(
                "radius",
                Kind::Expression,
                false,
                "radius of a ball, or of a disc's edge (to the middle of a rim's section)",
            ),
            key("axis", Kind::Expressions, false, "of a wheel or disc: \"x\", \"y\", \"z\" or [x, y, z] in `body`"),
            key("tube", Kind::Expression, false, "radius of the section of a rim; 0 by default: a thin disc"),
            key("semi_axes", Kind::Expressions, false, "of an ellipsoid, along the axes of `body`"),
            key(
                "surface",
                Kind::Text,
                false,
                "`plane` (default), `sphere` about the origin of `on`, `cylinder` about its z axis, `height`",
            ),
            key(
                "height",
                Kind::Expression,
                false,
                "z of the surface by `NAME.s` and `NAME.t`, x and y of the place of contact",
            ),
            key("surface_radius", Kind::Expression, false, "radius of the sphere or cylinder"),
            key("outside", Kind::Flag, false, "true: it rolls on the outside; inside by default"),
        ],
        "rolling without slipping on a plane, sphere, cylinder or smooth surface",
    ),
    elements(
        "tyre",
        &[
            NAME,
            key("body", Kind::Text, true, "the wheel, a body or frame"),
            key("on", Kind::Text, false, "a body or frame: the ground is its plane z = 0; `world` by default"),
            key("center", Kind::Expressions, false, "centre of the wheel in `body`"),
            key(
                "axis",
                Kind::Expressions,
                false,
                "of the wheel, to the left of its way forward: \"x\", \"y\" (default), \"z\" or [x, y, z] in `body`",
            ),
            key("radius", Kind::Expression, false, "without load; that of the file by default"),
            key("stiffness", Kind::Expression, false, "load by deflection; that of the file by default"),
            key("progression", Kind::Expression, false, "load by square of the deflection; 0 by default"),
            key("damping", Kind::Expression, false, "load by rate of deflection; 0 by default"),
            key(
                "law",
                Kind::Text,
                false,
                "forces along the ground: `linear`, `brush`, `tmeasy`, `pac2002` or `none` (default)",
            ),
            key("file", Kind::Text, false, "of `pac2002`: a .tir file; its name counts from the folder of the scene"),
            key("mirrored", Kind::Flag, false, "of `pac2002`: true for the other side of the vehicle"),
            key("longitudinal", Kind::Expression, false, "of `linear`, `brush`: force by longitudinal slip"),
            key("cornering", Kind::Expression, false, "of `linear`, `brush`: force by slip angle"),
            key("camber", Kind::Expression, false, "of `linear`, `brush`: force by camber; 0 by default"),
            key("trail", Kind::Expression, false, "of `linear`: pneumatic trail; 0 by default"),
            key("half_length", Kind::Expression, false, "of `brush`: half the length of contact at nominal load"),
            key("contact_length", Kind::Expression, false, "of `tmeasy`: length of contact at nominal load"),
            key(
                "load",
                Kind::Expression,
                false,
                "nominal load; without it the stiffnesses of `linear` do not follow the load",
            ),
            key(
                "friction",
                Kind::Expression,
                false,
                "coefficient of friction of `brush`; of `tmeasy`, `pac2002` times that of their data (1 by default)",
            ),
            key("rolling", Kind::Expression, false, "coefficient of rolling resistance; 0 by default"),
            key(
                "effective_radius",
                Kind::Expression,
                false,
                "advance of free rolling by angle; distance of the centre from the contact, or that of the file, by default",
            ),
            key(
                "relaxation",
                Kind::Expressions,
                false,
                "relaxation length, or [longitudinal, lateral], or \"file\": slip gets states `NAME.kappa`, `NAME.tan_alpha`",
            ),
            key(
                "standstill_damping",
                Kind::Expressions,
                false,
                "of standing wheels that relax, or [longitudinal, lateral]; half the critical one of the nominal load by default",
            ),
            key("low_speed", Kind::Expression, false, "speed below which that damping acts; 2 m/s by default"),
            key("creep", Kind::Expression, false, "speed below which slip is a damper; 0.1 m/s by default"),
        ],
        "wheels on tyres: load, slip, forces and moments at the contact with a plane",
    ),
    elements(
        "skate",
        &[
            NAME,
            key("on", Kind::Text, true, "a body or frame"),
            AT,
            RPY,
            key(
                "side",
                Kind::Expressions,
                false,
                "the direction in which its point does not move: \"x\", \"y\" (default), \"z\" or [x, y, z]",
            ),
        ],
        "knife edges and axles that do not slip sideways",
    ),
    elements(
        "gear",
        &[
            NAME,
            key(
                "from",
                Kind::Text,
                true,
                "a joint that turns about or shifts along one axis; `rod.angle` of one with two",
            ),
            key("to", Kind::Text, true, "the other joint"),
            key("ratio", Kind::Expression, false, "rate of `to` by rate of `from`"),
            key("radii", Kind::Expressions, false, "of two wheels, [from, to], at their teeth"),
            key("teeth", Kind::Expressions, false, "of two wheels, [from, to]"),
            key(
                "internal",
                Kind::Flag,
                false,
                "true: one wheel is a ring around the other, and both turn the same way",
            ),
            key("radius", Kind::Expression, false, "of a pinion with its rack"),
            key("carrier", Kind::Text, false, "the joint that turns the arm on which wheels are carried"),
            key("offset", Kind::Expression, false, "of `to` where `from` is zero; as at the start by default"),
        ],
        "gears, and racks with their pinions: joints whose coordinates go in a fixed ratio",
    ),
    elements(
        "bushing",
        &[
            NAME,
            FROM,
            TO,
            AT,
            RPY,
            TO_AT,
            key("to_rpy", Kind::Expressions, false, "orientation on `to`"),
            key("stiffness", Kind::Expressions, false, "[x, y, z] along the axes of the frame on `from`"),
            key("damping", Kind::Expressions, false, "[x, y, z] along these axes"),
            key("turn_stiffness", Kind::Expressions, false, "[x, y, z] by the angles of R = Rx Ry Rz"),
            key("turn_damping", Kind::Expressions, false, "[x, y, z] by the rates of these angles"),
        ],
        "springs and dampers along and about three axes: supports, bushings",
    ),
    elements(
        "spring",
        &[
            NAME,
            FROM,
            TO,
            AT,
            TO_AT,
            key("stiffness", Kind::Expression, false, "force by stretch"),
            key("damping", Kind::Expression, false, "force by rate of stretch"),
            key("free_length", Kind::Expression, false, "length without force; 0 by default"),
        ],
        "springs and dampers along the line between two points",
    ),
    elements(
        "inertia",
        &[
            NAME,
            key("value", Kind::Expression, false, "mass or moment of inertia of a scalar structure"),
            GEOMETRIC,
            IMPLICIT,
            EXPLICIT,
            key("mass", Kind::Expression, false, "mass of a vector element, with `position` or `velocity`"),
            POSITION,
            VELOCITY,
            key(
                "tensor",
                Kind::Expressions,
                false,
                "inertia tensor about the mass centre in body axes, with `spin`: [xx, yy, zz] or [xx, yy, zz, xy, xz, yz]",
            ),
            SPIN,
        ],
        "inertia elements {value, structure}, scalar or vectors of equation (7)",
    ),
    elements(
        "elastic",
        &[NAME, key("value", Kind::Expression, true, "stiffness c: force -c d, energy c d^2/2"), GEOMETRIC],
        "elastic elements {stiffness, deformation}",
    ),
    elements(
        "dissipative",
        &[NAME, key("value", Kind::Expression, true, "damping b: force -b d'"), GEOMETRIC, IMPLICIT, EXPLICIT],
        "dissipative elements {damping, structure}",
    ),
    elements(
        "force",
        &[
            NAME,
            key("value", Kind::Expression, false, "force or moment along a scalar structure"),
            GEOMETRIC,
            IMPLICIT,
            EXPLICIT,
            key(
                "force",
                Kind::Expressions,
                false,
                "force [x, y, z] at a point: of a frame (`on`), or by `position` or `velocity`",
            ),
            key("torque", Kind::Expressions, false, "torque [x, y, z]: on a frame (`on`), or by `spin`"),
            key("on", Kind::Text, false, "the body or frame on which force and torque act"),
            key("at", Kind::Expressions, false, "the point on it, [x, y, z]"),
            key("axes", Kind::Text, false, "`world` (default) or `frame`: the axes of force and torque"),
            POSITION,
            VELOCITY,
            SPIN,
        ],
        "force elements {force, structure}, scalar or vectors of equation (7)",
    ),
    names(
        "initial",
        Kind::Expression,
        "initial values of coordinates (`theta`), quasi-velocities (`v`) and rates (`theta'`)",
    ),
    names(
        "scale",
        Kind::Expression,
        "typical size of a state: its absolute tolerance is the relative one times this (1 in SI units)",
    ),
    elements(
        "guard",
        &[
            NAME,
            key("quantity", Kind::Expression, true, "what is watched"),
            key("warn_below", Kind::Expression, false, "a warning when the quantity falls below"),
            key("stop_below", Kind::Expression, false, "the run stops with an error when the quantity falls below"),
            key("message", Kind::Text, false, "what it means"),
        ],
        "limits of validity, watched while running",
    ),
    elements(
        "event",
        &[
            NAME,
            key("quantity", Kind::Expression, true, "the event is where this changes sign"),
            key("direction", Kind::Text, false, "`rising`, `falling` or `both` (default)"),
            key("stop", Kind::Flag, false, "true: the run ends there"),
        ],
        "events located and logged while running",
    ),
    Section {
        name: "outputs",
        shape: Shape::Keys,
        kind: Kind::Text,
        keys: &[key(
            "columns",
            Kind::Texts,
            false,
            "names or expressions, with an optional unit: `\"v_C[k]\"`, `\"power [kW]\"`",
        )],
        doc: "the columns of trajectory.csv; without it coordinates and quasi-velocities",
    },
    elements(
        "plot",
        &[
            key("title", Kind::Text, true, "title; its file name follows from it"),
            key("x", Kind::Text, false, "a column; `t` by default"),
            key("y", Kind::Texts, true, "columns; `v_C[k]` stands for all members"),
            key("equal_axes", Kind::Flag, false, "the same scale along both axes"),
        ],
        "plots drawn by `--plot`",
    ),
    Section {
        name: "run",
        shape: Shape::Keys,
        kind: Kind::Text,
        keys: &[
            key("until", Kind::Expression, false, "end of the run"),
            key("from", Kind::Expression, false, "start of the run, 0 by default"),
            key("tolerance", Kind::Expression, false, "relative tolerance, 1e-8 by default"),
            key("points", Kind::Expression, false, "number of output intervals, 300 by default"),
            key("method", Kind::Text, false, "`auto`, `dop853`, `cvode-bdf`, `cvode-adams`"),
            key("linear_solver", Kind::Text, false, "`ldl` (default) or `crout` for M u' = F"),
            key(
                "independent",
                Kind::Texts,
                false,
                "the independent rates, instead of the program's choice: `[\"x'\"]`",
            ),
            key("max_step", Kind::Expression, false, "longest step"),
        ],
        doc: "settings of a run; options of the command line go before them",
    },
];

/// The JSON Schema (draft 2020-12) of scene files, for editors.
pub fn json_schema() -> Value {
    let mut properties = Map::new();
    for section in SECTIONS {
        let body = match section.shape {
            Shape::Top => kind_schema(section.kind),
            Shape::Names => json!({ "type": "object", "additionalProperties": kind_schema(section.kind) }),
            Shape::Keys => keys_schema(section.keys),
            Shape::Elements => json!({ "type": "array", "items": keys_schema(section.keys) }),
        };
        properties.insert(section.name.into(), with_doc(body, section.doc));
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "headland scene",
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    })
}

fn with_doc(mut schema: Value, doc: &str) -> Value {
    if let Some(object) = schema.as_object_mut() {
        object.insert("description".into(), doc.into());
    }
    schema
}

fn keys_schema(keys: &[Key]) -> Value {
    let properties: Map<String, Value> =
        keys.iter().map(|k| (k.name.into(), with_doc(kind_schema(k.kind), k.doc))).collect();
    let required: Vec<&str> = keys.iter().filter(|k| k.required).map(|k| k.name).collect();
    json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
}

fn kind_schema(kind: Kind) -> Value {
    let expression = json!({ "type": ["number", "string"] });
    match kind {
        Kind::Text | Kind::Unit => json!({ "type": "string" }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Expression => expression,
        Kind::Expressions => {
            json!({ "anyOf": [expression, { "type": "array", "items": expression }] })
        }
        Kind::Texts => json!({ "type": "array", "items": { "type": "string" } }),
        Kind::Points => json!({
            "type": "object",
            "properties": {
                "x": { "type": "array", "items": { "type": "number" } },
                "y": { "type": "array", "items": { "type": "number" } },
                "z": { "type": "array", "items": { "type": "array", "items": { "type": "number" } } },
                "x_unit": { "type": "string" },
                "y_unit": { "type": "string" },
                "z_unit": { "type": "string" },
                "file": { "type": "string" },
            },
            "anyOf": [{ "required": ["x", "y"] }, { "required": ["file"] }],
            "additionalProperties": false,
        }),
    }
}
