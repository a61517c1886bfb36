//! Kinds of joints: their coordinates, their motion as steps, and what they forbid when they close a loop.

/// What kind of coordinate a joint has.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Freedom {
    /// An angle.
    Angle,
    /// A length.
    Length,
}

/// A kind of joint. The child's frame and the parent's fall together when all coordinates are zero.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum JointKind {
    /// No motion.
    Weld,
    /// Turn about the axis.
    Revolute,
    /// Shift along the axis.
    Prismatic,
    /// Turn and shift, coupled.
    Screw,
    /// Turn and shift.
    Cylindrical,
    /// Turns about x, then y.
    Universal,
    /// Shifts along x and y, turn about z.
    Planar,
    /// All turns.
    Spherical,
    /// Everything.
    Free,
}

impl JointKind {
    /// Names and kinds, in the order of the manual.
    pub(crate) const ALL: [(&'static str, Self); 9] = [
        ("weld", Self::Weld),
        ("revolute", Self::Revolute),
        ("prismatic", Self::Prismatic),
        ("screw", Self::Screw),
        ("cylindrical", Self::Cylindrical),
        ("universal", Self::Universal),
        ("planar", Self::Planar),
        ("spherical", Self::Spherical),
        ("free", Self::Free),
    ];

    /// Its name.
    pub(crate) fn word(self) -> &'static str {
        Self::ALL.iter().find(|(_, k)| *k == self).map_or("", |(n, _)| *n)
    }

    /// Coordinates beside the orientation: the part of the name behind the dot (empty: the joint's own name), its kind.
    pub(crate) fn coordinates(self) -> &'static [(&'static str, Freedom)] {
        match self {
            Self::Weld | Self::Spherical => &[],
            Self::Revolute | Self::Screw => &[("", Freedom::Angle)],
            Self::Prismatic => &[("", Freedom::Length)],
            Self::Cylindrical => &[("angle", Freedom::Angle), ("slide", Freedom::Length)],
            Self::Universal => &[("a", Freedom::Angle), ("b", Freedom::Angle)],
            Self::Planar => &[("x", Freedom::Length), ("y", Freedom::Length), ("angle", Freedom::Angle)],
            Self::Free => &[("x", Freedom::Length), ("y", Freedom::Length), ("z", Freedom::Length)],
        }
    }

    /// Whether it turns or shifts about one axis, which the scene may choose.
    pub(crate) fn has_axis(self) -> bool {
        matches!(self, Self::Revolute | Self::Prismatic | Self::Screw | Self::Cylindrical)
    }

    /// Whether it turns freely.
    pub(crate) fn is_ball(self) -> bool {
        matches!(self, Self::Spherical | Self::Free)
    }

    /// Components of the child's origin in the parent's frame that stay zero, in axes in which z is the joint's axis.
    pub(crate) fn fixed_positions(self) -> &'static [usize] {
        match self {
            Self::Weld | Self::Revolute | Self::Universal | Self::Spherical => &[0, 1, 2],
            Self::Prismatic | Self::Cylindrical => &[0, 1],
            Self::Planar => &[2],
            Self::Screw | Self::Free => &[],
        }
    }

    /// Entries `e_i · R e_j` of the relative rotation that stay zero, in the same axes.
    pub(crate) fn fixed_rotations(self) -> &'static [(usize, usize)] {
        match self {
            Self::Weld | Self::Prismatic => &[(0, 2), (1, 2), (1, 0)],
            Self::Revolute | Self::Cylindrical | Self::Planar => &[(0, 2), (1, 2)],
            Self::Universal => &[(0, 1)],
            Self::Spherical | Self::Screw | Self::Free => &[],
        }
    }
}
