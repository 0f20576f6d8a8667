//! Pens on X11: XInput2 tells how they press and lean, which end is down and whether their button is held, which winit
//! does not pass on.

use eframe::egui::{Context, pos2};
use modeler::pen::{Pen, PenState};
use wgpu::rwh::{HasWindowHandle, RawWindowHandle};
use x11rb::connection::Connection as _;
use x11rb::protocol::Event;
use x11rb::protocol::xinput::{
    ButtonPressEvent, ConnectionExt as _, DeviceClassData, DeviceType, EventMask, Fp3232, XIDeviceInfo,
    XIEventMask,
};
use x11rb::protocol::xproto::{ConnectionExt as _, Window};
use x11rb::rust_connection::RustConnection;

/// The version of XInput that is spoken.
const VERSION: [u16; 2] = [2, 2];

/// All devices, as XInput numbers them.
const ALL_DEVICES: u16 = 0;

/// Tilts that go further than this are no degrees, but shares of [`FARTHEST`].
const MOST_DEGREES: f64 = 90.0;

/// How far pens lean that tell it in units of their own, degrees.
const FARTHEST: f64 = 60.0;

/// The buttons on the side of a pen.
const BARREL: std::ops::RangeInclusive<u32> = 2..=3;

type Failure = Box<dyn std::error::Error>;

/// Listens to the pens over a window, if it is one of X11's, on a thread. Where that is not possible, a pen is a mouse.
pub fn listen(window: &impl HasWindowHandle, pen: Pen, ctx: Context) {
    let window: Window = match window.window_handle().map(|handle| handle.as_raw()) {
        Ok(RawWindowHandle::Xlib(handle)) => handle.window as Window,
        Ok(RawWindowHandle::Xcb(handle)) => handle.window.get(),
        _ => return,
    };
    // It ends with the connection, at the latest with the window.
    let work = move || drop(hear(window, &pen, &ctx));
    drop(std::thread::Builder::new().name("pens".into()).spawn(work));
}

/// Hears pens for as long as there is a screen.
fn hear(window: Window, pen: &Pen, ctx: &Context) -> Result<(), Failure> {
    let (connection, screen) = x11rb::connect(None)?;
    connection.xinput_xi_query_version(VERSION[0], VERSION[1])?.reply()?;
    let root = connection.setup().roots[screen].root;
    let changes = EventMask { deviceid: ALL_DEVICES, mask: vec![XIEventMask::HIERARCHY] };
    connection.xinput_xi_select_events(root, &[changes])?;
    let mut pens = all_pens(&connection, window, pen)?;
    loop {
        match connection.wait_for_event()? {
            Event::XinputHierarchy(_) => pens = all_pens(&connection, window, pen)?,
            Event::XinputMotion(event) => tell(&mut pens, &event, None, pen, ctx),
            Event::XinputButtonPress(event) => tell(&mut pens, &event, Some(true), pen, ctx),
            Event::XinputButtonRelease(event) => tell(&mut pens, &event, Some(false), pen, ctx),
            _ => {}
        }
    }
}

/// The pens that are plugged in, which from now on are heard over the window.
fn all_pens(connection: &RustConnection, window: Window, pen: &Pen) -> Result<Vec<Device>, Failure> {
    let mut pens = Vec::new();
    for info in connection.xinput_xi_query_device(ALL_DEVICES)?.reply()?.infos {
        pens.extend(Device::of(connection, &info)?);
    }
    let wanted = XIEventMask::MOTION | XIEventMask::BUTTON_PRESS | XIEventMask::BUTTON_RELEASE;
    let masks = pens.iter().map(|device| EventMask { deviceid: device.id, mask: vec![wanted] });
    let masks: Vec<EventMask> = masks.collect();
    if !masks.is_empty() {
        connection.xinput_xi_select_events(window, &masks)?.check()?;
        // From now on pens are told from mice.
        pen.tell(PenState::default());
    }
    Ok(pens)
}

fn tell(pens: &mut [Device], event: &ButtonPressEvent, pressed: Option<bool>, pen: &Pen, ctx: &Context) {
    if let Some(device) = pens.iter_mut().find(|device| device.id == event.deviceid) {
        pen.tell(device.hear(event, pressed, ctx.pixels_per_point()));
        ctx.request_repaint();
    }
}

/// A number that a pen tells.
#[derive(Clone, Copy, Debug)]
struct Axis {
    number: usize,
    least: f64,
    most: f64,
    /// What it was last.
    value: f64,
}

/// One end of a pen; each end is a device of its own.
#[derive(Debug)]
struct Device {
    id: u16,
    is_eraser: bool,
    is_barrel_held: bool,
    pressure: Axis,
    tilt: [Option<Axis>; 2],
}

impl Device {
    /// The pen that a device is; none if it is something else.
    fn of(connection: &RustConnection, info: &XIDeviceInfo) -> Result<Option<Self>, Failure> {
        if info.type_ != DeviceType::SLAVE_POINTER {
            return Ok(None);
        }
        let (mut pressure, mut tilt) = (None, [None; 2]);
        for class in &info.classes {
            let DeviceClassData::Valuator(valuator) = &class.data else { continue };
            if valuator.label == 0 {
                continue;
            }
            let axis = Axis {
                number: usize::from(valuator.number),
                least: number(valuator.min),
                most: number(valuator.max),
                value: number(valuator.value),
            };
            match &connection.get_atom_name(valuator.label)?.reply()?.name[..] {
                b"Abs Pressure" => pressure = Some(axis),
                b"Abs Tilt X" => tilt[0] = Some(axis),
                b"Abs Tilt Y" => tilt[1] = Some(axis),
                _ => {}
            }
        }
        let name = String::from_utf8_lossy(&info.name).to_lowercase();
        Ok(pressure.map(|pressure| Self {
            id: info.deviceid,
            is_eraser: name.contains("eraser"),
            is_barrel_held: false,
            pressure,
            tilt,
        }))
    }

    /// What the pen says with an event: a motion, or that a button is pressed or let go.
    fn hear(&mut self, event: &ButtonPressEvent, pressed: Option<bool>, pixels_per_point: f32) -> PenState {
        for axis in std::iter::once(&mut self.pressure).chain(self.tilt.iter_mut().flatten()) {
            axis.hear(event);
        }
        if let Some(pressed) = pressed.filter(|_| BARREL.contains(&event.detail)) {
            self.is_barrel_held = pressed;
        }
        let at = [event.event_x, event.event_y].map(|fixed| fixed as f32 / 65536.0 / pixels_per_point);
        PenState {
            is_near: true,
            at: Some(pos2(at[0], at[1])),
            pressure: Some(self.pressure.share()),
            tilt: self.tilt.map(|axis| axis.map_or(0.0, Axis::degrees)),
            eraser: self.is_eraser,
            barrel: self.is_barrel_held,
        }
    }
}

impl Axis {
    /// Takes its value from an event that has one.
    fn hear(&mut self, event: &ButtonPressEvent) {
        let has =
            |axis: usize| event.valuator_mask.get(axis / 32).is_some_and(|word| word >> (axis % 32) & 1 == 1);
        if has(self.number) {
            // Values stand in the order of those axes that have one.
            let place = (0..self.number).filter(|axis| has(*axis)).count();
            self.value = event.axisvalues.get(place).map_or(self.value, |value| number(*value));
        }
    }

    /// 0 to 1.
    fn share(&self) -> f32 {
        let share = (self.value - self.least) / (self.most - self.least);
        if share.is_finite() { share.clamp(0.0, 1.0) as f32 } else { 1.0 }
    }

    fn degrees(self) -> f32 {
        let most = self.most.abs().max(self.least.abs());
        let degrees = if most <= MOST_DEGREES { self.value } else { self.value / most * FARTHEST };
        degrees.clamp(-MOST_DEGREES, MOST_DEGREES) as f32
    }
}

fn number(fixed: Fp3232) -> f64 {
    f64::from(fixed.integral) + f64::from(fixed.frac) / 4_294_967_296.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(detail: u32, valuator_mask: u32, values: &[i32]) -> ButtonPressEvent {
        ButtonPressEvent {
            deviceid: 9,
            detail,
            event_x: 150 << 16,
            event_y: (60 << 16) + (1 << 15),
            valuator_mask: vec![valuator_mask],
            axisvalues: values.iter().map(|value| Fp3232 { integral: *value, frac: 0 }).collect(),
            ..ButtonPressEvent::default()
        }
    }

    fn stylus() -> Device {
        let axis = |number, least, most| Axis { number, least, most, value: 0.0 };
        Device {
            id: 9,
            is_eraser: false,
            is_barrel_held: false,
            pressure: axis(2, 0.0, 2048.0),
            tilt: [Some(axis(3, -64.0, 63.0)), Some(axis(4, -1000.0, 1000.0))],
        }
    }

    #[test]
    fn axes_are_found_behind_those_that_say_nothing_and_keep_their_last_value() {
        let mut pen = stylus();
        // x, y, pressure, both tilts.
        let state = pen.hear(&event(0, 0b11111, &[7, 8, 512, 30, -500]), None, 1.5);
        assert_eq!((state.pressure, state.tilt), (Some(0.25), [30.0, -30.0]));
        assert_eq!(state.at, Some(pos2(100.0, 60.5 / 1.5)));
        // Only y and the pressure.
        let state = pen.hear(&event(0, 0b00110, &[8, 1024]), None, 1.5);
        assert_eq!((state.pressure, state.tilt), (Some(0.5), [30.0, -30.0]));
        assert_eq!(pen.hear(&event(0, 0, &[]), None, 1.5).pressure, Some(0.5));
    }

    #[test]
    fn the_button_on_the_side_is_held_until_it_is_let_go_and_the_tip_is_no_button() {
        let mut pen = stylus();
        assert!(!pen.hear(&event(1, 0, &[]), Some(true), 1.0).barrel);
        assert!(pen.hear(&event(2, 0, &[]), Some(true), 1.0).barrel);
        assert!(pen.hear(&event(0, 0b100, &[5]), None, 1.0).barrel);
        assert!(!pen.hear(&event(2, 0, &[]), Some(false), 1.0).barrel);
    }
}
