//! `headland derive`: the equations as text, LaTeX or C.

use clap::{Args, ValueEnum};
use headland::{Algorithm, DeriveOptions, Form, equations_text};

use crate::load::{derive_failure, load};
use crate::{Failure, FormArg, SceneArgs, print};

#[derive(Args)]
pub(crate) struct DeriveArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// How they are written
    #[arg(long, value_enum, default_value = "text")]
    form: FormArg,
    /// Which derivation, instead of the cheaper
    #[arg(long, value_enum)]
    algorithm: Option<AlgorithmArg>,
}

#[derive(Clone, Copy, ValueEnum)]
enum AlgorithmArg {
    /// [10]: structures differentiated by the quasi-velocities
    Direct,
    /// [9]: the holonomic equations, combined with G
    Combine,
}

pub(crate) fn derive(args: &DeriveArgs) -> Result<(), Failure> {
    let model = load(&args.scene, &[])?;
    let algorithm = match args.algorithm {
        None => Algorithm::Cheaper,
        Some(AlgorithmArg::Direct) => Algorithm::Direct,
        Some(AlgorithmArg::Combine) => Algorithm::Combine,
    };
    let equations = headland::derive(&model, &DeriveOptions { algorithm, ..DeriveOptions::default() })
        .map_err(|e| derive_failure(&model, &e))?;
    let form = match args.form {
        FormArg::Text => Form::Text,
        FormArg::Latex => Form::Latex,
        FormArg::C => Form::C,
    };
    print(&equations_text(&model, &equations, form))
}
