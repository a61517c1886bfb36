//! The names of a scene: what each stands for, and the members of families.

use std::collections::BTreeMap;
use std::sync::Arc;

use headland_expr::parse::{Item, Program, parse};
use headland_expr::{NodeId, Op, Spline};
use headland_surface::Grid;
use indexmap::IndexMap;
use rustc_hash::FxHashMap;

use crate::dimension::Dimension;
use crate::place::Place;

/// A text of the scene that was parsed, with its place.
#[derive(Clone, Debug)]
pub struct Formula {
    /// The parsed text.
    pub program: Program,
    /// Its text.
    pub text: Arc<str>,
    /// Its place.
    pub place: Place,
}

/// An index variable with its value.
pub type Binding = Option<(Arc<str>, i64)>;

/// One rule that defines a name or a member of it.
#[derive(Clone, Debug)]
pub struct Rule {
    /// What it is.
    pub formula: Formula,
    /// The index variable and its value for this member.
    pub binding: Binding,
}

/// What a name stands for. Members of a family have the keys 1, 2, …; a single thing has the key 0.
#[derive(Clone, Debug)]
pub enum Symbol {
    /// The time.
    Time,
    /// An index and the number of its members.
    Index(i64),
    /// A parameter with a number: its input, dimension and whether it is an angle.
    Parameter(Vec<(NodeId, Dimension, bool)>, bool),
    /// A coordinate: where its members stand among the model's coordinates.
    Coordinate(Members),
    /// A quasi-velocity, in the same way.
    QuasiVelocity(Members),
    /// A body or frame: where its members stand among the frames.
    Frame(Members),
    /// A joint: its coordinates have names of their own.
    Joint(Members),
    /// A definition, a prescribed coordinate or a parameter given by an expression.
    Definition(FxHashMap<i64, Rule>, DefinitionKind),
    /// A function by points, with the dimensions of abscissa and ordinate.
    Table(Arc<Spline>, Dimension, Dimension),
    /// A function of two variables by points, with the dimensions of x, y and z.
    Field(Arc<Grid>, [Dimension; 3]),
}

/// Where the members of a family stand in a list; the key 0 is a single thing without members.
#[derive(Clone, Default, Debug)]
pub struct Members(BTreeMap<i64, usize>);

impl Members {
    /// A single thing.
    pub fn single(position: usize) -> Self {
        Self(BTreeMap::from([(0, position)]))
    }

    /// A family.
    pub fn family(members: impl IntoIterator<Item = (i64, usize)>) -> Self {
        Self(members.into_iter().collect())
    }

    /// One more member; false if it is there already or if single and family are mixed.
    pub fn insert(&mut self, member: i64, position: usize) -> bool {
        let fits = self.0.keys().all(|m| (*m == 0) == (member == 0));
        let new = fits && !self.0.contains_key(&member);
        if new {
            self.0.insert(member, position);
        }
        new
    }

    /// Position of a member.
    pub fn get(&self, member: i64) -> Option<usize> {
        self.0.get(&member).copied()
    }

    /// Whether an index is needed.
    pub fn is_family(&self) -> bool {
        !self.0.contains_key(&0)
    }

    /// The largest member; 0 for a single thing and for an empty family.
    pub fn last(&self) -> i64 {
        self.0.keys().next_back().copied().unwrap_or(0)
    }

    /// Members and positions, ascending.
    pub fn iter(&self) -> impl Iterator<Item = (i64, usize)> + '_ {
        self.0.iter().map(|(m, p)| (*m, *p))
    }
}

/// Which section a definition stands in.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DefinitionKind {
    /// `[parameters]`: may use parameters only.
    Parameter,
    /// `[prescribed]`: may use parameters and time only.
    Prescribed,
    /// `[definitions]`
    Definition,
}

impl Symbol {
    /// What it is, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Symbol::Time => "the time",
            Symbol::Index(_) => "an index",
            Symbol::Parameter(..) | Symbol::Definition(_, DefinitionKind::Parameter) => "a parameter",
            Symbol::Coordinate(..) => "a coordinate",
            Symbol::QuasiVelocity(..) => "a quasi-velocity",
            Symbol::Frame(..) => "a body or frame",
            Symbol::Joint(..) => "a joint",
            Symbol::Definition(_, DefinitionKind::Prescribed) => "a prescribed coordinate",
            Symbol::Definition(..) => "a definition",
            Symbol::Table(..) | Symbol::Field(..) => "a table",
        }
    }
}

/// All names of a scene.
#[derive(Default, Debug)]
pub struct Symbols {
    /// By name.
    pub by_name: IndexMap<Arc<str>, Symbol>,
    /// Arrays among the parameters: name and length, known before anything else.
    pub lengths: FxHashMap<String, i64>,
    /// Parameters that are plain numbers, usable in index expressions.
    pub integers: FxHashMap<String, f64>,
}

/// A name on the left of a scene's entry: `theta`, `psi[k+1]`, `x'`.
#[derive(Clone, Debug)]
pub struct Key {
    /// The name.
    pub name: String,
    /// Its index.
    pub index: Option<Program>,
    /// How many primes.
    pub primes: u8,
}

/// Reads the left side of an entry.
///
/// # Errors
/// A sentence, if it is not a name.
pub fn parse_key(text: &str) -> Result<Key, String> {
    let program = parse(text).map_err(|e| format!("`{text}` is not a name: {}", e.message))?;
    match <[Item; 1]>::try_from(program.items) {
        Ok([Item::Name { name, index, primes }]) => Ok(Key { name, index, primes }),
        _ => Err(format!("`{text}` is not a name, or a name with an index as in `theta[k]`")),
    }
}

impl Symbols {
    /// Value of an index expression: integers, index variables, numbers and lengths of parameters.
    ///
    /// # Errors
    /// A sentence that says what cannot stand in an index.
    pub fn index_value(&self, program: &Program, bindings: &[(Arc<str>, i64)]) -> Result<i64, String> {
        let mut stack: Vec<f64> = Vec::new();
        for item in &program.items {
            let value = match item {
                Item::Number(x, None) => *x,
                Item::Name { name, index: None, primes: 0 } => match bindings.iter().rev().find(|(n, _)| **n == **name)
                {
                    Some((_, k)) => *k as f64,
                    None => match (self.integers.get(name), self.lengths.get(name), self.by_name.get(name.as_str())) {
                        (Some(x), ..) => *x,
                        (None, Some(_), _) => return Err(format!("`{name}` is an array; its length is `len({name})`")),
                        (_, _, Some(Symbol::Index(_))) => {
                            return Err(format!(
                                "the index `{name}` has no value here; a name with `[{name}]` on the left gives it one"
                            ));
                        }
                        _ => return Err(format!("`{name}` is neither an index nor a parameter with a number")),
                    },
                },
                Item::Operator(Op::Neg) => -stack.pop().unwrap_or(0.0),
                Item::Operator(op) => {
                    let (b, a) = (stack.pop().unwrap_or(0.0), stack.pop().unwrap_or(0.0));
                    headland_expr::ops::apply(*op, a, b, 0.0)
                }
                Item::Call { function, args: 1 } if function == "len" => match stack.pop() {
                    Some(length) => length,
                    None => return Err("len() needs the name of an array".into()),
                },
                _ => return Err("an index is made of integers, index names, +, - and *".into()),
            };
            stack.push(value);
        }
        match stack.pop() {
            Some(x) if x == x.round() && x.abs() < 1e9 => Ok(x as i64),
            Some(x) => Err(format!("{x} is not an integer")),
            None => Err("empty index".into()),
        }
    }

    /// Replaces `len(name)` by its number, before anything else looks at a program.
    ///
    /// # Errors
    /// A sentence, if `name` is not an array.
    pub fn fold_lengths(&self, program: &mut Program) -> Result<(), String> {
        let mut i = 0;
        while i < program.items.len() {
            let before = i.checked_sub(1).map(|j| program.items[j].clone());
            match &mut program.items[i] {
                Item::Call { function, args } if function == "len" => {
                    let Some(Item::Name { name, index: None, primes: 0 }) = before.filter(|_| *args == 1) else {
                        return Err("`len` takes the name of an array: `len(l)`".into());
                    };
                    let length = match (self.lengths.get(&name), self.by_name.get(name.as_str())) {
                        (Some(n), _) => *n,
                        (None, Some(Symbol::Index(n))) => *n,
                        (None, _) => return Err(format!("`{name}` is not an array among the parameters")),
                    };
                    program.items[i - 1] = Item::Number(length as f64, None);
                    program.items.remove(i);
                    program.spans.remove(i);
                    continue;
                }
                Item::Name { index: Some(index), .. } => self.fold_lengths(index)?,
                Item::Sum { body, .. } => self.fold_lengths(body)?,
                _ => {}
            }
            i += 1;
        }
        Ok(())
    }

    /// The index variable that a program uses freely (not bound by a `sum`).
    ///
    /// # Errors
    /// A sentence, if it uses two.
    pub fn free_index(&self, programs: &[&Program]) -> Result<Option<Arc<str>>, String> {
        let mut found: Option<Arc<str>> = None;
        let mut work: Vec<(&Program, Vec<&str>)> = programs.iter().map(|p| (*p, Vec::new())).collect();
        while let Some((program, bound)) = work.pop() {
            for item in &program.items {
                match item {
                    Item::Name { name, index, .. } => {
                        if let Some(index) = index {
                            work.push((index, bound.clone()));
                        } else if !bound.contains(&name.as_str())
                            && let Some((key, Symbol::Index(_))) = self.by_name.get_key_value(name.as_str())
                        {
                            match &found {
                                Some(other) if other != key => {
                                    return Err(format!("uses two indices, `{other}` and `{key}`; one is allowed"));
                                }
                                _ => found = Some(key.clone()),
                            }
                        }
                    }
                    Item::Sum { index, body } => {
                        let mut bound = bound.clone();
                        bound.push(index);
                        work.push((body, bound));
                    }
                    _ => {}
                }
            }
        }
        Ok(found)
    }

    /// The members that an index expression on the left names: `(member, binding)`; key 0 without an index.
    ///
    /// # Errors
    /// A sentence that says what is wrong with the index.
    pub fn members(&self, index: Option<&Program>) -> Result<Vec<(i64, Binding)>, String> {
        let Some(index) = index else { return Ok(vec![(0, None)]) };
        match self.free_index(&[index])? {
            None => Ok(vec![(self.index_value(index, &[])?, None)]),
            Some(variable) => {
                let Some(Symbol::Index(n)) = self.by_name.get(&*variable) else { return Ok(Vec::new()) };
                (1..=*n)
                    .map(|k| Ok((self.index_value(index, &[(variable.clone(), k)])?, Some((variable.clone(), k)))))
                    .collect()
            }
        }
    }
}

/// Name of a member: `theta[2]`, `body[2].x`, or the name itself for the key 0.
pub fn member_name(name: &str, member: i64) -> String {
    match (member, name.split_once('.')) {
        (0, _) => name.to_string(),
        (_, None) => format!("{name}[{member}]"),
        (_, Some((owner, part))) => format!("{owner}[{member}].{part}"),
    }
}
