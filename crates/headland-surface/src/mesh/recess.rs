//! [`recess_query`]: the exact spherical recess by parry.

use super::parry;
use crate::contact::{Contact, ContactError};

/// Nearest point of a spherical recess of `radius`, m, about the origin, to a ball's centre inside of it, by parry's
/// `Ball::project_local_point(point, solid = false)`.
///
/// parry answers NaN at the very centre, where all points are equally near; here that is an error. Against the closed form,
/// [`Shape::Sphere`](crate::Shape) inside, it differs by rounding.
///
/// # Errors
/// [`ContactError::Ambiguous`] at the centre, [`ContactError::NotFinite`].
pub fn recess_query(radius: f64, point: [f64; 3]) -> Result<Contact, ContactError> {
    if point.iter().any(|x| !x.is_finite()) {
        return Err(ContactError::NotFinite { point });
    }
    let (foot, beyond) = parry::project_on_ball(radius, point);
    if foot.iter().any(|x| !x.is_finite()) {
        return Err(ContactError::Ambiguous { point, distance: radius });
    }
    let normal = foot.map(|x| -x / radius);
    Ok(Contact { distance: -beyond, foot, normal, curvatures: Some([-1.0 / radius; 2]) })
}
