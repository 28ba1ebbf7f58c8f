//! The scripts of all participants, by machine.

use novamind::record::clock::{ScriptedClock, parse_nanoseconds};

use crate::console::ConsoleParticipant;
use crate::diary::{BREAK, Diary, END, QUESTION_BEFORE_FIRST_WEEK, WEEK};
use crate::lab::StudyLab;
use crate::plain::PlainParticipant;

/// Plays the scripts of the first machine: a complete session, a pause, a time limit, and absences.
pub fn play_first_machine(lab: &StudyLab) -> Vec<Diary> {
    let clock = ScriptedClock::start(parse_nanoseconds("2026-03-02T09:00:00Z"));
    vec![
        play_without_breaks(lab, &clock),
        play_with_breaks(lab, &clock),
        play_out_of_time(lab, &clock),
        play_with_absences(lab, &clock),
    ]
}

/// Plays a complete session from the first page to the last page.
fn play_without_breaks(lab: &StudyLab, clock: &ScriptedClock) -> Diary {
    let mut player = ConsoleParticipant::arrive(lab, "m1", "P01", clock);
    player.agree(&[], 30);
    player.start_run();
    player.answer(QUESTION_BEFORE_FIRST_WEEK, "6 enter", "6", 5);
    player.wait(20);
    player.show_screen("2", "cash");
    player.wait(7);
    player.look_up("i", "cash-change", 3);
    player.show_screen("3", "customers");
    player.select("enter", "group", "S1");
    player.wait(2);
    player.show_screen("9", "sql");
    player.query("SELECT count(*) FROM ledger", "");
    player.wait(9);
    player.show_screen("0", "journal");
    player.keep_notes("ads for S1", 3);
    player.play_week("wait", 4, 6);
    player.report(8);
    player.show_screen("8", "tools");
    player.set_price("12");
    finish_console_session(player)
}

/// Stops the clock once, and leaves once for several hours.
fn play_with_breaks(lab: &StudyLab, clock: &ScriptedClock) -> Diary {
    let mut player = ConsoleParticipant::arrive(lab, "m1", "P02", clock);
    player.agree(&[], 20);
    player.start_run();
    player.answer(QUESTION_BEFORE_FIRST_WEEK, "2 enter", "2", 4);
    player.wait(11);
    player.pause("lunch", 1800);
    player.answer(BREAK, "1 enter", "no", 3);
    player.wait(12);
    player.play_week("think", 1, 2);
    player.report(3);
    player.leave_for(3 * 3600);
    player.answer(BREAK, "2 enter", "yes", 3);
    finish_console_session(player)
}

/// Exceeds the time limit of the second week.
fn play_out_of_time(lab: &StudyLab, clock: &ScriptedClock) -> Diary {
    let mut player = ConsoleParticipant::arrive(lab, "m1", "P03", clock);
    player.agree(&[], 20);
    player.start_run();
    player.answer(QUESTION_BEFORE_FIRST_WEEK, "1 enter", "1", 4);
    player.play_week("go", 1, 2);
    player.report(3);
    player.wait(20);
    player.exceed_week_limit();
    player.report(3);
    player.answer(WEEK, "1 enter", "first", 5);
    finish_console_session(player)
}

/// Presses no key for several minutes, focuses another window, and suspends the program.
fn play_with_absences(lab: &StudyLab, clock: &ScriptedClock) -> Diary {
    let mut player = ConsoleParticipant::arrive(lab, "m1", "P04", clock);
    player.agree(&[], 20);
    player.start_run();
    player.answer(QUESTION_BEFORE_FIRST_WEEK, "7 enter", "7", 4);
    player.idle(200);
    player.wait(5);
    player.lose_focus(40);
    player.show_screen("4", "product");
    player.wait(6);
    player.suspend(100);
    player.wait(7);
    player.play_week("go", 1, 2);
    player.report(3);
    finish_console_session(player)
}

/// Plays the remaining weeks and answers all questions.
fn finish_console_session(mut player: ConsoleParticipant<'_>) -> Diary {
    while !player.diary.over {
        player.wait(2);
        player.play_week("on", 4, 6);
        if player.diary.over {
            break;
        }
        player.report(8);
        if player.diary.weeks.len() == 2 {
            player.answer(WEEK, "2 enter", "second", 5);
        }
    }
    player.answer(END, "'guessed' tab", "guessed", 6);
    player.read_final_page(5);
    player.finish()
}

/// Plays the scripts of the second machine: participants decline, withdraw, mistype the label, and lose the terminal.
pub fn play_second_machine(lab: &StudyLab) -> Vec<Diary> {
    let clock = ScriptedClock::start(parse_nanoseconds("2026-03-03T09:00:00Z"));
    vec![
        ConsoleParticipant::arrive(lab, "m2", "P05", &clock).decline(15),
        play_and_withdraw(lab, &clock),
        play_with_mistakes(lab, &clock),
        play_with_hang_up(lab, &clock),
    ]
}

fn play_and_withdraw(lab: &StudyLab, clock: &ScriptedClock) -> Diary {
    let mut player = ConsoleParticipant::arrive(lab, "m2", "P06", clock);
    player.agree(&[], 20);
    player.start_run();
    player.answer(QUESTION_BEFORE_FIRST_WEEK, "7 enter", "7", 4);
    player.play_week("go", 1, 2);
    player.report(3);
    player.withdraw()
}

/// Enters two wrong labels, runs an invalid query, and undoes a price.
fn play_with_mistakes(lab: &StudyLab, clock: &ScriptedClock) -> Diary {
    let mut player = ConsoleParticipant::arrive(lab, "m2", "P07", clock);
    player.agree(&["P99", "../x"], 20);
    player.start_run();
    player.answer(QUESTION_BEFORE_FIRST_WEEK, "3 enter", "3", 4);
    player.show_screen("9", "sql");
    player.query("SELECT nothing FROM ledger", "sql_error");
    player.show_screen("8", "tools");
    player.set_price("12");
    player.set_price_again("15");
    player.undo();
    player.play_week("go", 1, 2);
    player.report(3);
    finish_console_session(player)
}

/// Loses the terminal while typing a rationale.
fn play_with_hang_up(lab: &StudyLab, clock: &ScriptedClock) -> Diary {
    let mut player = ConsoleParticipant::arrive(lab, "m2", "P08", clock);
    player.agree(&[], 20);
    player.start_run();
    player.answer(QUESTION_BEFORE_FIRST_WEEK, "3 enter", "3", 4);
    let mut player = player.hang_up_with_text(lab, "m2", "half", 2400);
    player.answer(BREAK, "1 enter", "no", 3);
    finish_console_session(player)
}

/// Plays the scripts of the third machine in plain mode: a pause, a killed program, a closed terminal, and a session
/// in two parts.
pub fn play_third_machine(lab: &StudyLab) -> Vec<Diary> {
    vec![
        play_in_plain_mode(lab),
        play_with_kill(lab),
        play_with_closed_terminal(lab),
        play_in_two_sessions(lab),
    ]
}

fn play_in_plain_mode(lab: &StudyLab) -> Diary {
    let mut plain = PlainParticipant::arrive(lab, "m3", "P09");
    plain.answer(QUESTION_BEFORE_FIRST_WEEK, "4", "4");
    plain.call("set_prices", "A=12");
    plain.query("SELECT count(*) FROM ledger");
    plain.write_note("ads for S1");
    plain.look_up_and_read_inbox("churn", "churn");
    plain.pause("tea");
    plain.answer(BREAK, "1", "no");
    finish_plain_session(plain)
}

fn play_with_kill(lab: &StudyLab) -> Diary {
    let mut plain = PlainParticipant::arrive(lab, "m3", "P10");
    plain.answer(QUESTION_BEFORE_FIRST_WEEK, "1", "1");
    plain.play_week("go");
    let mut plain = plain.kill_and_return();
    plain.answer(BREAK, "2", "yes");
    finish_plain_session(plain)
}

fn play_with_closed_terminal(lab: &StudyLab) -> Diary {
    let mut plain = PlainParticipant::arrive(lab, "m3", "P11");
    plain.answer(QUESTION_BEFORE_FIRST_WEEK, "7", "7");
    plain.call("set_prices", "A=10 B=20");
    let mut plain = plain.hang_up_and_return();
    plain.answer(BREAK, "1", "no");
    finish_plain_session(plain)
}

fn play_in_two_sessions(lab: &StudyLab) -> Diary {
    let mut plain = PlainParticipant::arrive(lab, "m3", "P12");
    plain.answer(QUESTION_BEFORE_FIRST_WEEK, "2", "2");
    plain.play_week("go");
    let mut plain = plain.quit_and_return();
    plain.answer(BREAK, "1", "no");
    finish_plain_session(plain)
}

fn finish_plain_session(mut plain: PlainParticipant<'_>) -> Diary {
    while !plain.diary.over {
        plain.play_week("on");
        if plain.diary.weeks.len() == 2 {
            plain.answer(WEEK, "2", "second");
        }
    }
    plain.answer(END, "guessed", "guessed");
    plain.finish()
}
