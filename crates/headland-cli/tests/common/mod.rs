//! The built program, run as a user does.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

/// What a call left behind.
pub struct Called {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// A folder of its own that goes with the test.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("headland-cli-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap_or_else(|e| panic!("{e}"));
        Self(path)
    }

    /// Calls `headland` in this folder.
    pub fn call(&self, args: &[&str]) -> Called {
        let output = Command::new(env!("CARGO_BIN_EXE_headland")).args(args).current_dir(&self.0).output();
        let output = output.unwrap_or_else(|e| panic!("{e}"));
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap_or_else(|e| panic!("{e}"));
        Called {
            code: output.status.code().unwrap_or_else(|| panic!("{args:?}: ended by a signal")),
            stdout: text(&output.stdout),
            stderr: text(&output.stderr),
        }
    }

    /// A call that must succeed without a word on stderr.
    pub fn good(&self, args: &[&str]) -> String {
        let called = self.call(args);
        assert_eq!((called.code, called.stderr.as_str()), (0, ""), "{args:?}\n{}", called.stdout);
        called.stdout
    }

    /// A call with wrong input: exit 2, a message on stderr, nothing on stdout.
    #[track_caller]
    pub fn wrong(&self, args: &[&str], messages: &[&str]) {
        let called = self.call(args);
        assert_eq!(called.code, 2, "{args:?}: {}{}", called.stdout, called.stderr);
        assert_eq!(called.stdout, "", "{args:?}");
        assert!(!called.stderr.contains("panicked"), "{}", called.stderr);
        for message in messages {
            assert!(called.stderr.contains(message), "{args:?}: no `{message}` in\n{}", called.stderr);
        }
    }

    pub fn write(&self, name: &str, text: &str) -> String {
        std::fs::write(self.0.join(name), text).unwrap_or_else(|e| panic!("{e}"));
        name.into()
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub fn files(&self, folder: &str) -> Vec<String> {
        let list = std::fs::read_dir(self.0.join(folder)).unwrap_or_else(|e| panic!("{folder}: {e}"));
        let mut names: Vec<String> = list.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A scene that is shipped.
pub fn model(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").join(name);
    path.display().to_string()
}

/// A stone that falls from `x0`; `@` is replaced by more of the scene.
pub fn stone(more: &str) -> String {
    let text = r#"title = "stone"
[parameters]
m = "2 kg"
g = "9.81 m/s^2"
x0 = "10 m"
loads = ["1 N", "2 N"]
[coordinates]
x = "m"
[[inertia]]
name = "m"
value = "m"
geometric = "x"
[[force]]
name = "weight"
value = "-m*g"
geometric = "x"
[initial]
x = "x0"
"x'" = 0
[run]
until = "1 s"
"#;
    format!("{text}{more}")
}
