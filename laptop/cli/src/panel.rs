//! Draws the picture of `listen --live` in the terminal: values, spikes, losses, and the reasons for values that are
//! not exact.

use crate::stop::Stop;
use anyhow::{Context, Result, bail};
use lab::events::{Item, LinkTally, Stream, Values};
use lab::flight::{Flight, visible};
use ratatui::backend::CrosstermBackend;
use ratatui::layout::{Constraint, Layout};
use ratatui::style::{Color, Style};
use ratatui::widgets::{Paragraph, Row, Table, Wrap};
use ratatui::{Frame, Terminal, TerminalOptions, Viewport};
use spikewire::link::{Received, Withheld};
use spikewire::{Polarity, Tick};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::fmt::Write;
use std::io::{self, IsTerminal, Stdout};
use std::rc::Rc;
use std::thread;
use std::time::{Duration, Instant};

/// Duration that the raster of spikes shows, in µs.
const WINDOW: u32 = 2_000_000;
/// Minimum time between two drawings of the panel.
const PERIOD: Duration = Duration::from_millis(50);
/// Maximum time, in µs, that a received tick adds to the elapsed time on the panel. If the sender restarts, its ticks
/// may jump by more.
const MOST_STEP: u32 = 1_000_000;
/// Number of lines below the channels. They show the numbers of received and lost frames, and the reasons why values
/// may differ from the sender's.
const FOOTER: u16 = 3;
/// Maximum number of channels that are drawn.
const MOST_CHANNELS: usize = 24;

/// The content of the picture: the values and spikes of every channel that have been received.
pub(crate) struct Panel {
    channels: Vec<Channel>,
    /// Number of neurons of each channel.
    neurons: u16,
    now: Option<Tick>,
    /// Time since the first frame, by the sender's clock, in µs.
    elapsed: u64,
    spikes: u64,
}

#[derive(Default)]
struct Channel {
    name: String,
    unit: String,
    value: Option<f64>,
    /// Reason that the value is not exact; `None` if it is exact.
    withheld: Option<Withheld>,
    /// Time and direction of the spikes that the raster shows.
    spikes: VecDeque<(Tick, Polarity)>,
}

impl Panel {
    /// Makes an empty panel for channels with `neurons` neurons each. A channel is added when it first sends, and is
    /// named by its number.
    pub(crate) fn new(neurons: usize) -> Self {
        let neurons = u16::try_from(neurons).unwrap_or(u16::MAX).max(1);
        Self { channels: Vec::new(), neurons, now: None, elapsed: 0, spikes: 0 }
    }

    /// Makes a panel with the channels of a flight.
    pub(crate) fn of_flight(flight: &Flight) -> Self {
        let mut panel = Self::new(flight.neurons());
        panel.channels.extend(flight.channels.iter().map(|own| Channel {
            name: visible(&own.name),
            unit: visible(&own.unit),
            ..Channel::default()
        }));
        panel
    }

    /// Wraps a decoder so that the panel shows the frames that the decoder receives, and the values that it returns.
    pub(crate) fn noting<'a>(
        panel: &Rc<RefCell<Self>>,
        values: Box<dyn Values + 'a>,
    ) -> Box<dyn Values + 'a> {
        Box::new(Noting { panel: Rc::clone(panel), values })
    }

    /// Returns the channel to which an address belongs. The panel adds the channel if it is new. Returns `None` if a
    /// new channel's number, counted from 0, is [`MOST_CHANNELS`] or higher.
    fn channel(&mut self, address: u16) -> Option<&mut Channel> {
        let place = usize::from(address / self.neurons);
        if place >= self.channels.len() && place < MOST_CHANNELS {
            let more = self.channels.len()..=place;
            let more = more.map(|own| Channel { name: own.to_string(), ..Channel::default() });
            self.channels.extend(more);
        }
        self.channels.get_mut(place)
    }

    /// Adds the spikes of a received frame, and moves the panel's time to the time of the frame.
    fn hear(&mut self, received: &Received<'_>) {
        for event in received.frame.events() {
            self.spikes += 1;
            self.reach(event.tick);
            if let Some(channel) = self.channel(event.address) {
                channel.spikes.push_back((event.tick, event.polarity));
            }
        }
        self.reach(received.frame.tick());
        let Some(now) = self.now else { return };
        for channel in &mut self.channels {
            channel.spikes.retain(|(tick, _)| since(now, *tick) < WINDOW);
        }
    }

    /// Moves the panel's time forward to `tick`, unless `tick` is earlier.
    fn reach(&mut self, tick: Tick) {
        let step = self.now.map_or(0, |now| since(tick, now));
        if step.cast_signed() >= 0 {
            self.elapsed += u64::from(step.min(MOST_STEP));
            self.now = Some(tick);
        }
    }

    /// Draws a line for each channel. Below the channels, draws the numbers of received and lost frames, and the
    /// reasons why values may differ from the sender's.
    fn draw(&self, frame: &mut Frame<'_>, tally: &LinkTally) {
        let [table, footer] =
            Layout::vertical([Constraint::Fill(1), Constraint::Length(FOOTER)]).areas(frame.area());
        let longest = |text: fn(&Channel) -> &str, title: &str| {
            let lengths = self.channels.iter().map(|own| text(own).chars().count());
            lengths.max().unwrap_or(0).max(title.len()) as u16
        };
        let (names, units) = (longest(|own| &own.name, "channel"), longest(|own| &own.unit, ""));
        let raster = table.width.saturating_sub(names + units + 10 + 5 + 4);
        let rows = self.channels.iter().map(|own| self.row(own, raster));
        let widths = [names, 10, units, 5, raster].map(Constraint::Length);
        let seconds = WINDOW / 1_000_000;
        let title = format!("spikes of the last {seconds} s");
        let header = Row::new(["channel", "     value", "", "", &title]);
        frame.render_widget(Table::new(rows, widths).header(header.style(GREY)), table);
        let text = Paragraph::new(self.counts(tally)).wrap(Wrap { trim: true });
        frame.render_widget(text, footer);
    }

    /// Returns the table row of a channel: name, value, unit, whether the value is exact, and spikes.
    fn row(&self, channel: &Channel, width: u16) -> Row<'_> {
        let is_exact = channel.value.is_some() && channel.withheld.is_none();
        let (mark, style) = match channel.value {
            None => ("none", GREY),
            Some(_) if is_exact => ("exact", Style::new().fg(Color::Green)),
            Some(_) => ("held", Style::new().fg(Color::Yellow)),
        };
        let value = channel.value.map_or_else(String::new, |value| format!("{value:10.4}"));
        let cells = [
            channel.name.clone(),
            value,
            channel.unit.clone(),
            mark.to_owned(),
            self.raster(channel, width),
        ];
        Row::new(cells).style(style)
    }

    /// Formats the spikes of a channel as a line of `width` characters, with the latest spike at the right. A character
    /// stands for a short time. The upper half of the character is filled if there was an up spike in this time, and
    /// the lower half if there was a down spike.
    fn raster(&self, channel: &Channel, width: u16) -> String {
        const GLYPHS: [char; 4] = ['·', '▀', '▄', '█'];
        let mut cells = vec![0; usize::from(width)];
        for (tick, polarity) in &channel.spikes {
            let age = self.now.map_or(0, |now| u64::from(since(now, *tick)));
            let place = age * u64::from(width) / u64::from(WINDOW);
            let bit = if matches!(polarity, Polarity::Up) { 1 } else { 2 };
            if let Some(cell) = cells.iter_mut().rev().nth(place as usize) {
                *cell |= bit;
            }
        }
        cells.into_iter().map(|cell| GLYPHS[cell]).collect()
    }

    /// Formats the time and the numbers of spikes, received frames and lost frames. Further lines name the channels
    /// whose values may differ from the sender's, each line with the reason.
    fn counts(&self, tally: &LinkTally) -> String {
        let LinkTally { frames, lost, gaps, .. } = tally;
        let (seconds, spikes) = (self.elapsed as f64 / 1e6, self.spikes);
        let mut text =
            format!("{seconds:.2} s; {spikes} spikes; {frames} frames, {lost} lost in {gaps} gaps");
        let mut reasons: Vec<(Withheld, Vec<&str>)> = Vec::new();
        for own in &self.channels {
            let Some(why) = own.withheld else { continue };
            match reasons.iter_mut().find(|(known, _)| *known == why) {
                Some((_, names)) => names.push(&own.name),
                None => reasons.push((why, vec![&own.name])),
            }
        }
        for (why, names) in reasons {
            let _ = write!(text, "\n{}: {why}", names.join(", ")); // a string takes all
        }
        text
    }
}

const GREY: Style = Style::new().fg(Color::DarkGray);

/// Returns the time in µs from `tick` to `later`.
fn since(later: Tick, tick: Tick) -> u32 {
    later.micros().wrapping_sub(tick.micros())
}

/// A decoder that also passes its frames and values on to a panel.
struct Noting<'a> {
    panel: Rc<RefCell<Panel>>,
    values: Box<dyn Values + 'a>,
}

impl Noting<'_> {
    /// Copies the values in `items` to the panel. Also copies the reason that a channel's value is not exact, for every
    /// channel.
    fn note(&self, items: &[Item]) {
        let mut panel = self.panel.borrow_mut();
        for item in items {
            if let Item::Value { address, value, .. } = *item
                && let Some(channel) = panel.channel(address)
            {
                channel.value = Some(value);
            }
        }
        for (place, channel) in (0..).zip(&mut panel.channels) {
            channel.withheld = self.values.withheld(place);
        }
    }
}

impl Values for Noting<'_> {
    fn apply(&mut self, received: &Received<'_>, items: &mut Vec<Item>) {
        let known = items.len();
        self.values.apply(received, items);
        self.panel.borrow_mut().hear(received);
        self.note(&items[known..]);
    }

    fn finish(&mut self, items: &mut Vec<Item>) {
        let known = items.len();
        self.values.finish(items);
        self.note(&items[known..]);
    }

    fn count(&self, tally: &mut LinkTally) {
        self.values.count(tally);
    }

    fn withheld(&self, channel: u16) -> Option<Withheld> {
        self.values.withheld(channel)
    }
}

/// The part of the terminal in which a panel is drawn. Earlier output stays visible above this part.
pub(crate) struct Screen {
    terminal: Terminal<CrosstermBackend<Stdout>>,
    panel: Rc<RefCell<Panel>>,
    drawn: Option<Instant>,
}

impl Screen {
    /// Reserves as many lines of the terminal as the panel needs.
    ///
    /// # Errors
    /// Returns an error if standard output is no terminal, or if the terminal does not report the position of its
    /// cursor.
    pub(crate) fn new(panel: &Rc<RefCell<Panel>>) -> Result<Self> {
        if !io::stdout().is_terminal() {
            bail!("--live draws in a terminal, and standard output is none");
        }
        let channels = panel.borrow().channels.len();
        let channels = if channels == 0 { MOST_CHANNELS / 2 } else { channels };
        let viewport = Viewport::Inline(1 + channels as u16 + FOOTER);
        let backend = CrosstermBackend::new(io::stdout());
        let terminal = Terminal::with_options(backend, TerminalOptions { viewport });
        let terminal = terminal.context("--live: the terminal does not say where its cursor is")?;
        Ok(Self { terminal, panel: Rc::clone(panel), drawn: None })
    }

    /// Draws the panel if at least [`PERIOD`] has passed since it was last drawn. With `wait`, keeps drawing until the
    /// laptop's clock has caught up with the sender's clock, or until `stop` ends the command.
    ///
    /// # Errors
    /// Returns an error if the terminal cannot be written.
    pub(crate) fn update(&mut self, stream: &Stream, wait: bool, stop: &Stop) -> Result<()> {
        loop {
            if self.drawn.is_none_or(|drawn| drawn.elapsed() >= PERIOD) {
                self.draw(stream)?;
            }
            let is_early = self.panel.borrow().elapsed > u64::from(stop.tick().micros());
            if !wait || !is_early || stop.is_due() {
                return Ok(());
            }
            thread::sleep(PERIOD / 10);
        }
    }

    /// Draws the panel a last time; it stays in the terminal, with the cursor below.
    ///
    /// # Errors
    /// Returns an error if the terminal cannot be written.
    pub(crate) fn finish(&mut self, stream: &Stream) -> Result<()> {
        self.draw(stream)?;
        let bottom = self.terminal.get_frame().area().bottom();
        self.terminal.set_cursor_position((0, bottom.saturating_sub(1)))?;
        println!();
        Ok(())
    }

    fn draw(&mut self, stream: &Stream) -> Result<()> {
        let tally = stream.tally().link.unwrap_or_default();
        let panel = self.panel.borrow();
        self.terminal.draw(|frame| panel.draw(frame, &tally))?;
        self.drawn = Some(Instant::now());
        Ok(())
    }
}

#[cfg(test)]
mod tests;
