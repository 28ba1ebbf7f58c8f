//! Tests that a long feed has no repetition and no mechanically detectable errors.

use super::customers::tests::{author, situations};
use super::*;
use novamind_world::events::{Engagement, PostCause, Sentiment, Severity, Trend};
use novamind_world::identifiers::Group;

const NO_ENGAGEMENT: Engagement = Engagement { likes: 0, shares: 0, virality: 0.0 };

/// Generates a long feed that covers all situations and groups.
fn generate_feed() -> Vec<(Post, String)> {
    let (params, streams) = (Params::bundled(), Streams::new(11));
    let mut writer = PostWriter::default();
    let mut posts = Vec::new();
    let post =
        |sentiment, matter, author| Post { post: 0, author, sentiment, engagement: NO_ENGAGEMENT, matter };
    for group in Group::all() {
        for (opinion, tone) in situations() {
            let company = group.is_enterprise();
            let possible = match opinion.cause {
                PostCause::Cancelled => !company,
                PostCause::Lost { .. } => company,
                _ => true,
            };
            if !possible {
                continue;
            }
            posts.push(post(tone, PostSubject::Opinion(opinion), Some(author(group))));
        }
        for perspective in 0..11 {
            let trend = [Trend::Expansion, Trend::Neutral, Trend::Contraction][perspective as usize % 3];
            let matter = PostSubject::Economy { trend, pmi: 40.0 + f64::from(perspective), perspective };
            posts.push(post(Sentiment::Neutral, matter, None));
            let matter = PostSubject::CompetitorEvent {
                name: perspective % 5,
                perspective: perspective % 7,
                severity: Severity::Minor,
                estimate: 0.02,
            };
            posts.push(post(Sentiment::Neutral, matter, None));
        }
        let matter = PostSubject::Comment { own_post: 1, group, effect: 0.8 };
        posts.push(post(Sentiment::Positive, matter, None));
    }
    let numbered = posts.into_iter().enumerate();
    let write = |(at, post): (usize, Post)| {
        let post = Post { post: at as u32 + 1, ..post };
        (post, writer.write(&post, None, &params, &streams))
    };
    numbered.map(write).collect()
}

#[test]
fn no_two_equal_texts_within_sixty_posts() {
    let texts: Vec<String> = generate_feed().into_iter().map(|(_, text)| text).collect();
    for (at, text) in texts.iter().enumerate() {
        let before = &texts[at.saturating_sub(60)..at];
        let repeats = before.iter().any(|other| other.to_lowercase() == text.to_lowercase());
        assert!(!repeats, "post {at} repeats: {text}");
    }
    assert!(texts.len() > 2500);
}

#[test]
fn posts_have_no_mechanical_errors() {
    for (post, text) in generate_feed() {
        assert!(!text.is_empty() && text == text.trim(), "{post:?}: {text:?}");
        assert!(text.split_whitespace().count() <= 150, "{text}");
        for slip in ["  ", " .", " ,", "..", " ?", "{", "}", "[", "]", "|", "a/an", "?.", ":.", ".,", "!."] {
            assert!(!text.contains(slip), "{slip:?} in {text}");
        }
        let words: Vec<String> = text.split_whitespace().map(str::to_lowercase).collect();
        assert!(words.windows(2).all(|pair| pair[0] != pair[1]), "a word is repeated: {text}");
        for pair in ["i are", "we am", "i was we", "we is", "our my", "my our"] {
            assert!(!words.join(" ").contains(pair), "{pair:?} in {text}");
        }
        let first = text.chars().next().expect("a character");
        let casual = post.author.is_some_and(|author| {
            wording::SpeechRegister::for_group(Some(author.group)) == wording::SpeechRegister::Casual
        });
        assert!(!first.is_lowercase() || casual, "{text}");
        assert!(text.ends_with(['.', '!', '?', ')', '(', ']']), "{text}");
        let hidden = ["satisfaction", "sentiment", "participation", "c_max", "q_min"];
        assert!(hidden.iter().all(|word| !text.to_lowercase().contains(word)), "{text}");
    }
}

#[test]
fn enterprises_write_we_and_individuals_write_i() {
    for (post, text) in generate_feed() {
        let Some(author) = post.author else { continue };
        let words: Vec<String> =
            text.split(|c: char| !c.is_alphanumeric() && c != '\'').map(str::to_lowercase).collect();
        let says = |word: &str| words.iter().any(|spoken| spoken == word);
        if author.group.is_enterprise() {
            for word in ["i", "i'm", "i've", "i'll", "my", "me", "mine"] {
                assert!(!says(word), "{word} in {text}");
            }
        } else if author.group.id() != "D_S04" {
            // Authors at agencies sometimes write "we" for their team.
            assert!(!says("we") && !says("we're"), "{text}");
        }
    }
}

#[test]
fn posts_are_deterministic() {
    assert_eq!(generate_feed(), generate_feed());
}
