use std::sync::Arc;

use super::*;
use crate::expr::Expr;
use crate::field::{Field, Wave, field_part};
use crate::scalar::Scalar;
use crate::spline::Spline;

fn both(e: Expr<'_>) -> (String, String) {
    let Expr::Node(graph, id) = e else { panic!("a number") };
    (expression(graph, Style::Text, id), expression(graph, Style::Latex, id))
}

#[track_caller]
fn check(e: Expr<'_>, text: &str, latex: &str) {
    assert_eq!(both(e), (text.to_string(), latex.to_string()));
}

#[test]
fn reads_like_a_page() {
    let graph = Graph::new();
    let n = |x: f64| Expr::Const(x);
    let (x, y, psi) = (graph.input("x"), graph.input("speed"), graph.input("psi[1]"));
    check(x + n(-3.0), "x - 3", "x - 3");
    check(n(2.0) * x + n(1.0), "2*x + 1", "2\\,x + 1");
    check(x * n(-2.0) + y, "speed - 2*x", "\\mathit{speed} - 2\\,x");
    check(-(x + y), "-(x + speed)", "-\\left(x + \\mathit{speed}\\right)");
    check(x - (y - n(1.0)), "x - (speed - 1)", "x - \\left(\\mathit{speed} - 1\\right)");
    check(x / (y * psi), "x/(speed*psi[1])", "\\frac{x}{\\mathit{speed}\\,\\psi_{1}}");
    check(psi.sin() * x, "x*sin(psi[1])", "x\\,\\sin\\psi_{1}");
    check(psi.sin().powi(2) * y, "speed*sin(psi[1])^2", "\\mathit{speed}\\,\\sin^{2}\\psi_{1}");
    check((x + y).sin(), "sin(x + speed)", "\\sin\\left(x + \\mathit{speed}\\right)");
    check(x.sin(), "sin(x)", "\\sin x");
    check((x + y).powi(-2), "(x + speed)^(-2)", "\\left(x + \\mathit{speed}\\right)^{-2}");
    check(x.ln().powi(2), "log(x)^2", "\\left(\\ln x\\right)^{2}");
    check((x * y).pow(n(1.5)), "(x*speed)^1.5", "\\left(x\\,\\mathit{speed}\\right)^{1.5}");
    check(n(-1.5e-3) * x / y, "-0.0015*x/speed", "-\\frac{1.5\\cdot 10^{-3}\\,x}{\\mathit{speed}}");
    check(n(2.0) * x * (n(3.0) * y), "2*3*x*speed", "2 \\cdot 3\\,x\\,\\mathit{speed}");
    check(
        Expr::select(x - y, x, n(0.0)),
        "if(x - speed >= 0, x, 0)",
        "\\begin{cases} x & \\text{if } x \\ge \\mathit{speed} \\\\ 0 & \\text{otherwise} \\end{cases}",
    );
    let table = Spline::new("torque", &[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0]).unwrap();
    check(x.spline(&table, 1), "torque'(x)", "\\mathit{torque}'\\left(x\\right)");
    let wave: Arc<dyn Field> = Arc::new(Wave { name: "wave".into(), rate: [1.0; 3], phase: [0.0; 3] });
    check(
        Expr::field([x, y, n(1.0)], &wave, 0),
        "wave(x, speed, 1)",
        r"\mathit{wave}\left(x, \mathit{speed}, 1\right)",
    );
    check(
        n(2.0) * Expr::field([x, y, n(1.0)], &wave, field_part(2, 0, 1)),
        "2*wave'xxz(x, speed, 1)",
        r"2\,\partial_{xxz}\,\mathit{wave}\left(x, \mathit{speed}, 1\right)",
    );
    check(
        (x * x).abs() * x.min(y),
        "abs(x^2)*min(x, speed)",
        "\\left|x^{2}\\right|\\,\\min\\left(x, \\mathit{speed}\\right)",
    );
}

#[test]
fn mirrored_differences_and_signs() {
    let graph = Graph::new();
    let (a, b, c) = (graph.input("a"), graph.input("b"), graph.input("c"));
    let d = a - b;
    check(b - a, "b - a", "b - a");
    check(c * d, "c*(a - b)", "c\\,\\left(a - b\\right)");
    check(c + (b - a), "c - (a - b)", "c - \\left(a - b\\right)");
    check(Expr::Const(-3.0) * a - b, "-(b + 3*a)", "-\\left(b + 3\\,a\\right)");
    check(c - Expr::Const(-3.0) * a, "c + 3*a", "c + 3\\,a");
    check(c * (Expr::Const(-3.0) / a), "-3*c/a", "-\\frac{3\\,c}{a}");
}

#[test]
fn names_of_scenes() {
    for (name, latex, c) in [
        ("theta[1]", "\\theta_{1}", "theta_1"),
        ("theta[1]'", "\\dot{\\theta}_{1}", "theta_1_dot"),
        ("theta''", "\\ddot{\\theta}", "theta_ddot"),
        ("v_C[2]", "v_{C,2}", "v_C_2"),
        ("x_A1", "x_{A1}", "x_A1"),
        ("psi1", "\\psi_{1}", "psi1"),
        ("F_B[k]", "F_{B,k}", "F_B_k"),
        ("speed", "\\mathit{speed}", "speed"),
        ("x_rear'", "\\dot{x}_{\\mathrm{rear}}", "x_rear_dot"),
        ("sin", "\\mathit{sin}", "sin_"),
        ("2nd", "\\mathit{2nd}", "n_2nd"),
        ("x", "x", "x_"),
    ] {
        assert_eq!((latex_name(name).as_str(), c_name(name).as_str()), (latex, c), "{name}");
    }
}

/// The train of bogies, eqs. (12)–(16) of the article, one bogie.
#[test]
fn listing_names_definitions_and_temporaries() {
    let graph = Graph::new();
    let one = Expr::Const(1.0);
    let (psi, s) = (graph.input("psi[1]"), graph.input("s_A[1]'"));
    let (alpha, beta, l) = (graph.input("alpha[1]"), graph.input("beta[1]"), graph.input("l[1]"));
    let v = s * (psi.cos().powi(2) + alpha.powi(2) * psi.sin().powi(2)).sqrt();
    let delta = (alpha * psi.tan()).atan();
    let vc = s * (psi.cos().powi(2) + beta.powi(2) * psi.sin().powi(2)).sqrt();
    let w = s * psi.sin() / l;
    let named: Vec<(NodeId, String)> =
        [(v, "s_A[2]'"), (delta, "delta[1]"), (w, "theta[1]'")].map(|(e, name)| (graph.id(e), name.to_string())).into();
    let root = |e: Expr<'_>, name: &str| (name.to_string(), graph.id(e));
    let shared = (v + delta * w).sin();
    let roots = [root(v, "s_A[2]'"), root(vc, "s_C[1]'"), root(shared * vc, "P"), root(shared + one, "Q")];
    let print = |style| listing(&graph, style, &roots, &named, &ListingOptions::of(style));
    let text = "\
s_A[2]' = s_A[1]'*sqrt(cos(psi[1])^2 + alpha[1]^2*sin(psi[1])^2)
delta[1] = atan(alpha[1]*tan(psi[1]))
s_C[1]' = s_A[1]'*sqrt(cos(psi[1])^2 + sin(psi[1])^2*beta[1]^2)
theta[1]' = s_A[1]'*sin(psi[1])/l[1]
x_1 = sin(s_A[2]' + delta[1]*theta[1]')
P = s_C[1]'*x_1
Q = x_1 + 1
";
    assert_eq!(print(Style::Text).to_string(), text);
    let latex = r"\dot{s}_{A,2} = \dot{s}_{A,1}\,\sqrt{\cos^{2}\psi_{1} + \alpha_{1}^{2}\,\sin^{2}\psi_{1}}
\delta_{1} = \arctan\left(\alpha_{1}\,\tan\psi_{1}\right)
\dot{s}_{C,1} = \dot{s}_{A,1}\,\sqrt{\cos^{2}\psi_{1} + \beta_{1}^{2}\,\sin^{2}\psi_{1}}
\dot{\theta}_{1} = \frac{\dot{s}_{A,1}\,\sin\psi_{1}}{l_{1}}
x_{1} = \sin\left(\dot{s}_{A,2} + \delta_{1}\,\dot{\theta}_{1}\right)
P = \dot{s}_{C,1}\,x_{1}
Q = x_{1} + 1
";
    assert_eq!(print(Style::Latex).to_string(), latex);
}

#[test]
fn text_is_short_and_c_is_unique() {
    let graph = Graph::new();
    let (a, b) = (graph.input("v[1]"), graph.input("v_1"));
    let mut e = a;
    for _ in 0..100_000 {
        e = (e + b).sin() * a;
    }
    assert!(format!("{e:?}").len() < 400);
    let id = graph.id(a * b);
    let text = c_function(&graph, "f", &[id], &[]);
    assert!(text.contains("v_1_2 = x[1]") && text.contains("y[0] = v_1*v_1_2;"), "{text}");
}
