//! A language model as voice on the command line: without answers the game continues, and the run records the model.

use std::net::TcpListener;

use crate::support::home::{Home, id};

/// Writes a settings file for a model at an address.
fn named(home: &Home, endpoint: &str, more: &str) -> String {
    let text = format!("endpoint = \"{endpoint}\"\nmodel = \"llama3\"\nseconds_a_week = 1\n{more}");
    home.write("voice.toml", text);
    home.0.path().join("configuration/voice.toml").display().to_string()
}

/// Returns an address of this machine without a server.
fn nobody() -> String {
    let port =
        TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a port").port();
    format!("http://127.0.0.1:{port}/v1")
}

#[test]
fn a_wrong_file_begins_no_run_and_is_named_with_line_and_key() {
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
        let file = named(&home, endpoint, more);
        let said = home.play(&["--new", "--days", "28", "--voice", &file], "");
        assert_ne!(said.code, 0, "{}", said.out);
        assert!(parts.iter().all(|part| said.err.contains(part)), "{}", said.err);
    }
    let file = named(&home, "http://127.0.0.1:1/v1", "");
    let baseline = ["--new", "--mode", "baseline", "--participant", "P01", "--voice", &file];
    let said = home.play(&baseline, "");
    assert!(said.code != 0 && said.err.contains("study.toml"), "{}", said.err);
    assert_eq!(std::fs::read_dir(home.runs()).expect("a folder").filter(|entry| entry.is_ok()).count(), 0);
}

#[test]
fn without_an_answer_the_game_goes_on_and_the_run_says_what_it_is() {
    let home = Home::new();
    let file = named(&home, &nobody(), "judge = true\n");
    let lines =
        "set_prices A=12\npost_social_media content=\"Prices are down 20% today.\"\nnext naive\nnext naive\n";
    let played = home.play(&["--new", "--days", "28", "--voice", &file], lines);
    assert_eq!(played.code, 0, "{}", played.err);
    assert_eq!(played.out.matches("The built-in voice replaces it").count(), 1, "{}", played.out);
    let run = home.only_run();
    let manifest = std::fs::read_to_string(run.join("run.toml")).expect("a manifest");
    assert!(manifest.contains("[voice]") && manifest.contains("model = \"llama3\""), "{manifest}");
    let verified = home.run(&["replay", &id(&run), "--verify"]);
    assert_eq!(verified.code, 0, "{}", verified.err);
    let report = home.run(&["report", &id(&run)]);
    assert!(report.out.contains("llama3 at 127.0.0.1"), "{}", report.out);
    let card = home.run(&["report", &id(&run), "--card"]);
    assert!(card.out.contains("A language model worded"), "{}", card.out);
    let again = home.play(&["--run", &id(&run)], "next naive\n");
    assert!(again.out.contains("name its file with --voice"), "{}", again.out);
}
