//! Leads per $1,000 by channel and group, as numbers with shaded cells.

use ratatui::layout::Rect;

use super::Customers;
use super::model::{CustomerData, ad_budget};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{dollars, grouped_number};
use novamind_report::measures::MIN_CHANNEL_LEADS;
use novamind_session::identifiers::Channel;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Align, Canvas, Click, first_visible_row};
use novamind_tui::text::format_count;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

pub struct ChannelMapPane;

impl Pane<Customers> for ChannelMapPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open]
    }

    fn figure(&self, customers: &Customers, context: &ScreenContext<'_>) -> Option<Figure> {
        figure(context.company, customers.map_cell)
    }

    fn handle_action(&self, customers: &mut Customers, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return vec![Effect::ShowTool(ToolId::SetTargetedAdSpend)];
        }
        customers.map_cell.handle_action(action, context.company.observation.known_groups.len());
        Vec::new()
    }

    fn handle_click(&self, customers: &mut Customers, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let groups = context.company.observation.known_groups.len().max(1);
        customers.map_cell = ChannelMapCell { channel: row / groups, group: row % groups };
        Vec::new()
    }

    fn border(&self, _: &Customers, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let open = context.keys.label(Action::Open).unwrap_or_default();
        PaneBorder {
            title: "Leads per $1,000".to_owned(),
            note: format!("measured over 28 days · █ best of at least {MIN_CHANNEL_LEADS} leads"),
            keys: format!("{open} set_targeted_ad_spend"),
            ..PaneBorder::default()
        }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let (market, place) = (&customers.data, customers.map_cell);
        draw(canvas, placement.area, context.company, market, place, placement.focused, placement.index);
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ChannelMapCell {
    pub channel: usize,
    /// Index of the group in the list of known groups.
    pub group: usize,
}

impl ChannelMapCell {
    fn handle_action(&mut self, action: Action, groups: usize) {
        let (last_channel, last_group) = (Channel::ALL.len() - 1, groups.saturating_sub(1));
        match action {
            Action::Up => self.channel = self.channel.saturating_sub(1),
            Action::Down => self.channel = (self.channel + 1).min(last_channel),
            Action::Left => self.group = self.group.saturating_sub(1),
            Action::Right => self.group = (self.group + 1).min(last_group),
            Action::First => self.group = 0,
            Action::Last => self.group = last_group,
            _ => {}
        }
    }
}

/// Height of the map without its border, in rows.
pub const MAP_HEIGHT: u16 = Channel::ALL.len() as u16 + 2;
const NAME_WIDTH: u16 = 18;
const CELL_WIDTH: u16 = 9;

/// Draws the map of channels and groups. Shades compare the channels within one group, because differences between
/// groups are too large.
fn draw(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &DisplayedCompany,
    market: &CustomerData,
    place: ChannelMapCell,
    focused: bool,
    pane: usize,
) {
    if area.width < NAME_WIDTH + CELL_WIDTH || area.height < 2 {
        return;
    }
    let groups = &company.observation.known_groups;
    let room = ((area.width - NAME_WIDTH) / CELL_WIDTH) as usize;
    let from = first_visible_row(place.group, room, groups.len());
    let head = Rect { height: 1, ..area };
    canvas.draw_text(Rect { width: NAME_WIDTH, ..head }, "channel", Role::Header);
    canvas.draw_column_marks(head, NAME_WIDTH, from > 0, groups.len() > from + room);
    for (at, group) in groups.iter().enumerate().skip(from).take(room) {
        let cell = cell_area(head, at - from);
        canvas.draw_aligned(Rect { width: CELL_WIDTH - 2, ..cell }, group.id(), Role::Header, Align::Right);
        let best = Channel::ALL
            .iter()
            .map(|channel| market.channel_measurement(*channel, *group))
            .filter(|measured| measured.leads >= MIN_CHANNEL_LEADS)
            .filter_map(|measured| measured.leads_per_thousand())
            .fold(0.0, f64::max);
        for (line, channel) in Channel::ALL.iter().enumerate() {
            let y = area.y + 1 + line as u16;
            if y >= area.bottom() {
                break;
            }
            let cell = Rect { y, ..cell };
            let value = market.channel_measurement(*channel, *group).leads_per_thousand();
            let selected = focused && (ChannelMapCell { channel: line, group: at }) == place;
            draw_cell(canvas, cell, value, best, selected);
            canvas.register_click(cell, Click::Row(pane, line * groups.len() + at));
        }
    }
    for (line, channel) in Channel::ALL.iter().enumerate() {
        let y = area.y + 1 + line as u16;
        if y < area.bottom() {
            canvas.draw_text(Rect { y, width: NAME_WIDTH, height: 1, ..area }, channel.id(), Role::Text);
        }
    }
    if area.height >= MAP_HEIGHT {
        let below = Rect { y: area.y + MAP_HEIGHT - 1, height: 1, ..area };
        canvas.draw_text(below, &cell_summary(company, market, place), Role::Text);
    }
}

fn cell_area(row: Rect, at: usize) -> Rect {
    Rect { x: row.x + NAME_WIDTH + at as u16 * CELL_WIDTH, width: CELL_WIDTH, ..row }
}

fn draw_cell(canvas: &mut Canvas<'_>, cell: Rect, value: Option<f64>, best: f64, selected: bool) {
    let Some(value) = value else {
        let role = if selected { Role::Selection } else { Role::Dim };
        canvas.draw_aligned(Rect { width: CELL_WIDTH - 2, ..cell }, "–", role, Align::Right);
        return;
    };
    let share = if best > 0.0 { value / best } else { 0.0 };
    let (glyph, role) = match share {
        // The channel has too few leads for a comparison.
        share if share > 1.0 || best == 0.0 => (" ", Role::Dim),
        share if share >= 0.999 => ("█", Role::Good),
        share if share >= 0.5 => ("▓", Role::Text),
        share if share >= 0.2 => ("▒", Role::Text),
        share if share > 0.0 => ("░", Role::Dim),
        _ => (" ", Role::Bad),
    };
    let decimals = if value == 0.0 || value >= 9.95 { 0 } else { 2 };
    let shown = if selected { Role::Selection } else { role };
    canvas.draw_aligned(Rect { width: CELL_WIDTH - 2, ..cell }, &grouped_number(value, decimals), shown, Align::Right);
    canvas.draw_text(Rect { x: cell.x + CELL_WIDTH - 1, width: 1, ..cell }, glyph, role);
}

/// Returns the figure of a cell, with a query for its source rows.
fn figure(company: &DisplayedCompany, place: ChannelMapCell) -> Option<Figure> {
    let (channel, group) = (Channel::ALL.get(place.channel)?, company.observation.known_groups.get(place.group)?);
    let sql = format!(
        "SELECT day, leads_generated, spend\nFROM ad_channel_leads\nWHERE channel_id = '{}' AND group_id = '{group}'\n    \
         AND day > {}\nORDER BY day DESC",
        channel.id(),
        i64::from(company.observation.day) - 28
    );
    let title = format!("leads of {group} through {} per $1,000 in 28 days", channel.id());
    Some(Figure { title, term: "cost-per-lead", sql: Some(sql), week_quantity: None })
}

fn cell_summary(company: &DisplayedCompany, market: &CustomerData, place: ChannelMapCell) -> String {
    let (Some(channel), Some(group)) =
        (Channel::ALL.get(place.channel), company.observation.known_groups.get(place.group))
    else {
        return String::new();
    };
    let (measured, now) = (market.channel_measurement(*channel, *group), ad_budget(company, *channel, *group));
    let pair = format!("{} → {}", channel.id(), group.id());
    if measured.spend <= 0.0 {
        return format!("{pair}: no ads in 28 days; budget now {}/day", dollars(now));
    }
    let each = match measured.leads {
        leads if leads > 0.0 => format!(", ${} each", grouped_number(measured.spend / leads, 2)),
        _ => String::new(),
    };
    let leads = format_count(measured.leads, "lead");
    format!("{pair}: {leads} for {}{each}; budget {}/day", dollars(measured.spend), dollars(now))
}
