//! A language model as voice on the command line. If the model does not answer, the run continues, and the record
//! names the model.

use std::net::TcpListener;

use crate::support::home::{Home, run_id};

/// Writes a settings file for a model at an address.
fn write_model_file(home: &Home, endpoint: &str, more: &str) -> String {
    let text = format!("endpoint = \"{endpoint}\"\nmodel = \"llama3\"\nseconds_a_week = 1\n{more}");
    home.write("voice.toml", text);
    home.0.path().join("configuration/voice.toml").display().to_string()
}

/// Returns a local address on which no server listens.
fn unreachable_endpoint() -> String {
    let port =
        TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a port").port();
    format!("http://127.0.0.1:{port}/v1")
}

#[test]
fn invalid_model_file_is_rejected() {
    let home = Home::new();
    for (endpoint, more, parts) in [
        ("https://api.example/v1", "", ["line 1, endpoint", "gateway on this machine"]),
        ("http://127.0.0.1:1/v1", "temperature = 1\n", ["line 4", "temperature"]),
        (
            "http://127.0.0.1:1/v1",
            "key_variable = \"NOVAMIND_NO_SUCH_KEY\"\n",
            ["NOVAMIND_NO_SUCH_KEY", "not set"],
        ),
    ] {
        let file = write_model_file(&home, endpoint, more);
        let program_output = home.play(&["--new", "--days", "28", "--voice", &file], "");
        assert_ne!(program_output.exit_code, 0, "{}", program_output.stdout);
        assert!(parts.iter().all(|part| program_output.stderr.contains(part)), "{}", program_output.stderr);
    }
    let file = write_model_file(&home, "http://127.0.0.1:1/v1", "");
    let baseline = ["--new", "--mode", "baseline", "--participant", "P01", "--voice", &file];
    let output = home.play(&baseline, "");
    assert!(output.exit_code != 0 && output.stderr.contains("study.toml"), "{}", output.stderr);
    assert_eq!(std::fs::read_dir(home.runs()).expect("a folder").filter(|entry| entry.is_ok()).count(), 0);
}

#[test]
fn run_continues_without_the_model() {
    let home = Home::new();
    let file = write_model_file(&home, &unreachable_endpoint(), "judge = true\n");
    let lines =
        "set_prices A=12\npost_social_media content=\"Prices are down 20% today.\"\nnext naive\nnext naive\n";
    let played = home.play(&["--new", "--days", "28", "--voice", &file], lines);
    assert_eq!(played.exit_code, 0, "{}", played.stderr);
    assert_eq!(played.stdout.matches("The built-in voice is used instead").count(), 1, "{}", played.stdout);
    let run = home.only_run();
    let manifest = std::fs::read_to_string(run.join("run.toml")).expect("a manifest");
    assert!(manifest.contains("[voice]") && manifest.contains("model = \"llama3\""), "{manifest}");
    let verified = home.run(&["replay", &run_id(&run), "--verify"]);
    assert_eq!(verified.exit_code, 0, "{}", verified.stderr);
    let report = home.run(&["report", &run_id(&run)]);
    assert!(report.stdout.contains("llama3 at 127.0.0.1"), "{}", report.stdout);
    let card = home.run(&["report", &run_id(&run), "--card"]);
    assert!(card.stdout.contains("A language model worded"), "{}", card.stdout);
    let program_output = home.play(&["--run", &run_id(&run)], "next naive\n");
    assert!(
        program_output.stdout.contains("name its settings file with --voice"),
        "{}",
        program_output.stdout
    );
}
