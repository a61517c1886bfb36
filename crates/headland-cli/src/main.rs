//! `headland`: the command line. Results to stdout, progress and warnings to stderr; exit 0 done, 1 the run failed,
//! 2 the input is wrong.

mod bench;
mod check;
mod derive;
mod files;
mod linearize;
mod load;
mod plot;
mod progress;
mod run;
mod table;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum};

/// Multibody dynamics for wheeled, rolling and coupled machines.
#[derive(Parser)]
#[command(name = "headland", version, about = "Multibody dynamics for wheeled, rolling and coupled machines", long_about = None)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Derive, integrate, write trajectory.csv and summary.json
    Run(run::RunArgs),
    /// Print the equations of motion
    Derive(derive::DeriveArgs),
    /// Linearise about the start, an equilibrium or a steady motion: A, B, eigenvalues
    #[command(alias = "linearise")]
    Linearize(linearize::LinearizeArgs),
    /// Say everything that is wrong with a scene, or what it is
    Check(SceneArgs),
    /// Time against error for methods and tolerances: a table, JSON, a plot
    Bench(bench::BenchArgs),
    /// Print the JSON Schema of scene files, for editors
    Schema,
    /// Run the reference problems and compare
    #[cfg(feature = "validate")]
    Validate(ValidateArgs),
}

/// A scene and what is set in it.
#[derive(Args)]
pub(crate) struct SceneArgs {
    /// Scene file
    model: PathBuf,
    /// Set a parameter, definition, initial value or setting: --set 'l=[4, 6]' --set 'gamma=0.1*sin(t)' --set run.points=10
    #[arg(long = "set", value_name = "NAME=VALUE")]
    sets: Vec<String>,
}

#[cfg(feature = "validate")]
#[derive(Args)]
struct ValidateArgs {
    /// Only problems whose name contains one of these
    names: Vec<String>,
    /// As JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum FormArg {
    Text,
    Latex,
    C,
}

/// How a command ended.
pub(crate) enum Failure {
    /// The input is wrong: exit 2.
    Input(String),
    /// The run failed: exit 1.
    Run(String),
}

impl<E: Into<headland::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Failure::Input(error.into().to_string())
    }
}

/// Writes results; a closed pipe is not an error, a full disk is.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::Run(format!("cannot write results: {e}"))),
        _ => Ok(()),
    }
}

/// Writes a line to stderr, wherever it leads.
pub(crate) fn tell(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Run(args) => run::run(&args),
        Command::Derive(args) => derive::derive(&args),
        Command::Linearize(args) => linearize::linearize(&args),
        Command::Check(args) => check::check(&args),
        Command::Bench(args) => bench::bench(&args),
        Command::Schema => print(&format!("{:#}\n", headland::model::format::json_schema())),
        #[cfg(feature = "validate")]
        Command::Validate(args) => validate(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Run(message)) => {
            tell(&format!("failed: {message}"));
            ExitCode::from(1)
        }
        Err(Failure::Input(message)) => {
            tell(&format!("error: {message}"));
            ExitCode::from(2)
        }
    }
}

#[cfg(feature = "validate")]
fn validate(args: &ValidateArgs) -> Result<(), Failure> {
    let results = headland_validation::run(&args.names);
    if results.is_empty() {
        let known = headland_validation::names().join(", ");
        return Err(Failure::Input(format!(
            "no reference problem is called {}; known: {known}",
            args.names.join(", ")
        )));
    }
    if args.json {
        print(&format!("{}\n", headland_validation::to_json(&results)))?;
    } else {
        print(&headland_validation::to_table(&results))?;
    }
    match results.iter().filter(|r| !r.passed()).count() {
        0 => Ok(()),
        n => Err(Failure::Run(format!("{n} of {} reference problems failed", results.len()))),
    }
}
