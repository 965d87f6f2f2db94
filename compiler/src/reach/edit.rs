//! The `after` that cures a program, as a change of its text.
use stochc_grammar::Span;
use stochc_grammar::tree::{Chain, Item, ItemKind, Place};

use super::{EventId, Subject};
use crate::finding::{Edit, Fix};
use crate::table::RoleId;
use crate::{FileId, Site};

/// Makes captures wait for a name; `None` where that cannot be written plainly: in loops and
/// patterns, for rows, and twice in one statement.
pub fn waits_for(subject: &Subject, captures: &[EventId], role: RoleId) -> Option<Fix> {
    if subject.plan.roles.key(role).scope != 0 {
        return None;
    }
    let name = subject.plan.roles.name(role, subject.symbols);
    let mut edits = Vec::new();
    for &capture in captures {
        edits.extend(wait(subject, capture, &name)?);
    }
    let mut places: Vec<Span> = edits.iter().map(|edit| edit.site.span).collect();
    places.sort_by_key(|span| (span.start, span.end));
    if (places.windows(2)).any(|pair| pair[0].end >= pair[1].start) {
        return None;
    }
    Some(Fix {
        title: format!("wait for `{name}`"),
        // One more order, and the same structure.
        safe: captures.len() == 1,
        edits,
    })
}

fn wait(subject: &Subject, capture: EventId, name: &str) -> Option<Vec<Edit>> {
    let event = subject.plan.event(capture);
    let is_elsewhere = event.site.file != subject.file
        || subject.plan.roles.key(event.role).scope != 0
        || (subject.plan.events.iter()).any(|other| {
            other.site == event.site && (other.role, other.deed) != (event.role, event.deed)
        });
    if is_elsewhere {
        return None;
    }
    let (chain, link) = (subject.assembly.body.iter())
        .filter_map(|item| match &item.kind {
            ItemKind::Phase(phase) => Some(&phase.body),
            _ => None,
        })
        .flatten()
        .find_map(|item| find(item, event.site.span))?;
    Some(write(subject, chain, link, name))
}

/// The link of a statement that stands in a place.
fn find(item: &Item, span: Span) -> Option<(&Chain, usize)> {
    let ItemKind::Chain(chain) = &item.kind else {
        return None;
    };
    let links = std::iter::once(&chain.head).chain(chain.links.iter().map(|link| &link.place));
    let places: Vec<&Place> = links.collect();
    let link = (places.windows(2))
        .position(|pair| (pair[0].span.start, pair[1].span.end) == (span.start, span.end))?;
    Some((chain, link))
}

fn write(subject: &Subject, chain: &Chain, link: usize, name: &str) -> Vec<Edit> {
    let at = |start: u32, end: u32, text: String| Edit {
        site: site(subject.file, start, end),
        text,
    };
    let end = chain
        .links
        .last()
        .map_or(chain.head.span, |link| link.place.span)
        .end;
    let end_of_after = chain
        .after
        .last()
        .map_or(end, |subject| subject.place.span.end);
    let Some(broken) = link.checked_sub(1) else {
        let text = if chain.after.is_empty() {
            " after "
        } else {
            ", "
        };
        return vec![at(end_of_after, end_of_after, format!("{text}{name}"))];
    };
    // Only the first capture of a chain can wait: the chain goes on in a line of its own.
    let place = &chain.links[broken].place;
    let text_of = |start, end| subject.sources.text(site(subject.file, start, end));
    let written = text_of(place.span.start, place.span.end);
    let block = match place.face {
        Some((_, face)) => text_of(place.span.start, face.start)
            .trim_end()
            .trim_end_matches('.'),
        None => written,
    };
    let waits = text_of(end, end_of_after);
    let indent = subject
        .sources
        .indent(site(subject.file, chain.head.span.start, end));
    vec![
        at(
            place.span.start,
            place.span.end,
            format!("{block}{waits}\n{indent}{written}"),
        ),
        at(end, end_of_after, format!(" after {name}")),
    ]
}

fn site(file: FileId, start: u32, end: u32) -> Site {
    Site {
        file,
        span: Span { start, end },
    }
}
