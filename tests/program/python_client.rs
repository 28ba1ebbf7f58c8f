//! The Python client: threads, several runs in one process, and retries of requests without a response.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::interfaces::{NEW_RUN_OPTIONS, Server};
use crate::support::home::Home;

/// Writes the client to a folder and returns the folder, or `None` if Python is not installed.
fn write_client(home: &Home) -> Option<PathBuf> {
    if Command::new("python3").arg("--version").stdout(Stdio::null()).status().is_err() {
        println!("SKIPPED: python3 is not installed");
        return None;
    }
    let folder = home.0.path().join("client");
    assert_eq!(home.run(&["serve", "--client", &folder.to_string_lossy()]).exit_code, 0);
    Some(folder)
}

#[track_caller]
fn run_python(home: &Home, client: &PathBuf, port: u16, program: &str) {
    let mut python = home.command("python3");
    python.env("PYTHONPATH", client).env("NOVAMIND_API_PORT", port.to_string());
    let output = python.args(["-c", program]).output().expect("python");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn read_trajectory(home: &Home) -> Vec<Value> {
    let text = std::fs::read_to_string(home.only_run().join("trajectory.jsonl")).expect("a trajectory");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

#[test]
fn client_connection_is_shared_by_four_threads() {
    let home = Home::new();
    let Some(client) = write_client(&home) else { return };
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    run_python(
        &home,
        &client,
        server.port,
        "
import threading, novamind
from novamind import infrastructure, pricing
errors = []
def work(number):
    try:
        for n in range(25):
            price = 10.0 + number + n / 100
            assert pricing.set_prices(A=price)['updated']['A'] == price
            infrastructure.get_cost_info()
            assert novamind.query(f'SELECT {number} AS x')['rows'] == [{'x': number}]
            assert novamind.current_day() == 0
    except Exception as error:
        errors.append(repr(error))
threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
for thread in threads: thread.start()
for thread in threads: thread.join()
assert not errors, errors
",
    );
    let prices = read_trajectory(&home).iter().filter(|line| line["tool"] == "set_prices").count();
    assert_eq!(prices, 100);
}

#[test]
fn client_plays_two_runs_in_one_process() {
    let (home, other) = (Home::new(), Home::new());
    let Some(client) = write_client(&home) else { return };
    let token = home.0.path().join("token.txt");
    let first = Server::start(&home, &NEW_RUN_OPTIONS);
    let second =
        Server::start(&other, &[&NEW_RUN_OPTIONS[..], &["--token", &token.to_string_lossy()]].concat());
    let program = format!(
        "
import novamind
first = novamind.Client({}, '')
second = novamind.Client({}, open({:?}).read())
second.pricing.set_prices(A=14)
second.next_week('on', second.naive_predictions(), expected_day=0)
first.pricing.set_prices(A=15)
assert (first.current_day(), second.current_day(), novamind.current_day()) == (0, 7, 0)
try:
    second.next_week('on', second.naive_predictions(), expected_day=0)
except novamind.NovamindError as error:
    assert error.code == 'unexpected_day' and 'day 7' in str(error), error
else:
    raise SystemExit('not refused')
",
        first.port, second.port, token
    );
    run_python(&home, &client, first.port, &program);
    let price = |home: &Home| {
        read_trajectory(home)
            .iter()
            .find(|line| line["tool"] == "set_prices")
            .map(|line| line["args"]["A"].clone())
    };
    assert_eq!((price(&home), price(&other)), (Some(15.into()), Some(14.into())));
}

#[test]
fn client_plays_a_run_of_release_2() {
    let home = Home::new();
    let Some(client) = write_client(&home) else { return };
    let server = Server::start(&home, &crate::release_2::release_2_options());
    run_python(
        &home,
        &client,
        server.port,
        "
import novamind
from novamind import analytics, market, pricing, scripts
pricing.set_prices(A=10, B=20)
market.research_market()
scripts.register_script(name='s', code='SELECT 1')
scripts.run_script(name='s')
assert analytics.set_targeted_ops_spend()['total_extra_per_day'] == 0
assert novamind.dashboard() == ''
call = novamind.Connection().call
first = call('set_prices', {'A': 11}, request_id='a b/c')
assert novamind.request_status('a b/c') == {
    'request_id': 'a b/c', 'status': 'completed', 'result': {'success': True, 'data': first}}
assert novamind.request_status('other')['status'] == 'unknown'
try:
    call('set_prices', {'A': 12}, request_id='a b/c')
except novamind.NovamindError as error:
    assert error.code == 'request_id_payload_mismatch' and 'earlier request' in str(error), error
else:
    raise SystemExit('not refused')
assert novamind.next_week('on', novamind.naive_predictions())['day'] == 7 == novamind.current_day()
",
    );
    let first_release = Server::start(&home, &NEW_RUN_OPTIONS);
    run_python(
        &home,
        &client,
        first_release.port,
        "
import novamind
try:
    novamind.request_status('x')
except novamind.NovamindError as error:
    assert 'no route' in str(error), error
else:
    raise SystemExit('not refused')
",
    );
}

/// Reads the head and the body of an HTTP message.
fn read_message(stream: &mut TcpStream) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut piece = [0; 4096];
    loop {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        if let Some((head, body)) = text.split_once("\r\n\r\n") {
            let length = head
                .lines()
                .find_map(|line| line.to_lowercase().strip_prefix("content-length: ")?.parse().ok());
            if body.len() >= length.unwrap_or(0) {
                return bytes;
            }
        }
        let read = stream.read(&mut piece).expect("bytes");
        assert!(read > 0, "{text}");
        bytes.extend_from_slice(&piece[..read]);
    }
}

#[test]
fn lost_response_is_retried_and_runs_once() {
    let home = Home::new();
    let Some(client) = write_client(&home) else { return };
    let server = Server::start(&home, &NEW_RUN_OPTIONS);
    let listener = TcpListener::bind(("127.0.0.1", 0)).expect("a port");
    let (port, served) = (listener.local_addr().expect("an address").port(), server.port);
    let between = std::thread::spawn(move || {
        for attempt in 0..3 {
            let (mut from, _) = listener.accept().expect("a connection");
            let asked = read_message(&mut from);
            if attempt == 1 {
                let full = "HTTP/1.1 503 Service Unavailable\r\nretry-after: 1\r\ncontent-length: 2\r\nconnection: close\r\n\r\n{}";
                from.write_all(full.as_bytes()).expect("sent");
                continue;
            }
            let mut to = TcpStream::connect(("127.0.0.1", served)).expect("a connection");
            to.write_all(&asked).expect("sent");
            let answer = read_message(&mut to);
            // The response to the first attempt is lost.
            if attempt == 2 {
                from.write_all(&answer).expect("sent");
            }
        }
    });
    run_python(
        &home,
        &client,
        port,
        "
import novamind
around = {'point': 1e6, 'lower': 0, 'upper': 2e6}
forecasts = {f'cash_{weeks}wk': around for weeks in (1, 4, 12, 26)}
assert novamind.next_week('on', forecasts)['day'] == 7
",
    );
    between.join().expect("three attempts");
    let weeks = read_trajectory(&home).iter().filter(|line| line["kind"] == "week").count();
    assert_eq!(weeks, 1);
}
