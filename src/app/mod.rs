//! The window: the modeler on the screen, with a graphics card to draw it.

mod desk;
#[cfg(all(unix, not(target_os = "macos")))]
mod pens;
mod pipelines;
#[cfg(test)]
mod snapshots;
mod stage;

use crate::failure::Failure;
use desk::Files;
use eframe::{CreationContext, NativeOptions, egui};
use egui_wgpu::WgpuSetup;
use modeler::Modeler;
use modeler::dialog::Dialog;
use modeler::journal::LeftBehind;
use modeler::stage::NoStage;
use modeler::trace::Trace;
use stage::Card;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// The window's size at first, points.
const SIZE: [f32; 2] = [1280.0, 800.0];

/// The least size in which everything can be reached, points.
const LEAST: [f32; 2] = [480.0, 360.0];

/// The largest buffer that is asked of a graphics card, bytes: a surface of six million triangles.
const LARGEST_BUFFER: u64 = 1 << 30;

/// Opens the window, with a file on the table if one is named, and comes back when it is closed.
///
/// How long the user waits is written to `trace`, if it is given.
///
/// Errors: no display or no graphics driver, with what to do; a system that cannot run threads; a trace that cannot be
/// written.
pub fn run(file: Option<&Path>, state: Option<PathBuf>, trace: Option<&Path>) -> Result<(), Failure> {
    let trace = trace.map(trace_to).transpose()?;
    let mut options = NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Trullo")
            .with_app_id("trullo")
            .with_inner_size(SIZE)
            .with_min_inner_size(LEAST),
        ..NativeOptions::default()
    };
    ask_for_large_buffers(&mut options);
    let file = file.map(Path::to_path_buf);
    let create = move |context: &CreationContext| -> Result<Box<dyn eframe::App>, Box<dyn std::error::Error + Send + Sync>> {
        Ok(Box::new(App::new(context, file.as_deref(), state.as_deref(), trace)?))
    };
    eframe::run_native("Trullo", options, Box::new(create)).map_err(|error| Failure::Input(advice(&error)))
}

/// Errors: a file that cannot be made.
fn trace_to(path: &Path) -> Result<Trace, Failure> {
    let file = std::fs::File::create(path).map_err(|e| Failure::of(path, e))?;
    Ok(Trace::new(Box::new(file)))
}

/// Where sessions, settings and pictures are kept: with the user's other state.
pub fn state() -> Option<PathBuf> {
    let home = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let state = home("XDG_STATE_HOME")
        .or_else(|| home("LOCALAPPDATA"))
        .or_else(|| home("HOME").map(|home| home.join(".local/state")));
    state.map(|state| state.join("trullo"))
}

/// What to do where no window opens.
fn advice(error: &eframe::Error) -> String {
    let verbs = "or use the verbs of the command line (`trullo --help`), which need none";
    match error {
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => format!(
            "there is no display to open the modeler's window on; run Trullo in a desktop session, {verbs}"
        ),
        other => format!(
            "no graphics driver could be used for the modeler's window ({other}); install one for Vulkan or OpenGL \
             (on Debian and Ubuntu: mesa-vulkan-drivers), {verbs}"
        ),
    }
}

fn ask_for_large_buffers(options: &mut NativeOptions) {
    let WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup else { return };
    setup.device_descriptor = Arc::new(|adapter| {
        let has = adapter.limits();
        let base = match adapter.get_info().backend {
            wgpu::Backend::Gl => wgpu::Limits::downlevel_webgl2_defaults(),
            _ => wgpu::Limits::default(),
        };
        wgpu::DeviceDescriptor {
            label: Some("trullo"),
            required_limits: wgpu::Limits {
                max_buffer_size: has.max_buffer_size.min(LARGEST_BUFFER),
                max_texture_dimension_2d: has.max_texture_dimension_2d.min(16384),
                ..base
            },
            ..Default::default()
        }
    });
}

/// The modeler and its graphics card.
struct App {
    modeler: Modeler,
    card: Option<Card>,
}

impl App {
    fn new(
        context: &CreationContext,
        file: Option<&Path>,
        state: Option<&Path>,
        trace: Option<Trace>,
    ) -> std::io::Result<Self> {
        let ctx = context.egui_ctx.clone();
        let sessions = state.map(|state| state.join("sessions"));
        let left = sessions.as_deref().map(LeftBehind::all).unwrap_or_default();
        let mut modeler =
            Modeler::new(Box::new(Files::default()), sessions, Arc::new(move || ctx.request_repaint()))?;
        modeler.trace = trace;
        if let Some(state) = state {
            modeler.keep_in(state);
        }
        #[cfg(all(unix, not(target_os = "macos")))]
        pens::listen(context, modeler.pen.clone(), context.egui_ctx.clone());
        if let Some(file) = file {
            modeler.begin_with(file.to_path_buf());
        }
        if !left.is_empty() {
            modeler.dialog = Some(Dialog::LeftBehind(left));
        }
        Ok(Self { modeler, card: context.wgpu_render_state.clone().map(Card::new) })
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        if let (Some(trace), Some(took)) = (&mut self.modeler.trace, frame.info().cpu_usage) {
            trace.painted(Duration::from_secs_f32(took.max(0.0)));
        }
        match &mut self.card {
            Some(card) => self.modeler.ui(ui, card),
            None => self.modeler.ui(ui, &mut NoStage),
        }
        let ctx = ui.ctx();
        let name = self.modeler.title();
        ctx.send_viewport_cmd(egui::ViewportCommand::Title(name));
        if self.modeler.quits() {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        } else if ctx.input(|input| input.viewport().close_requested()) {
            self.modeler.quit();
            if !self.modeler.quits() {
                ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            }
        }
    }

    fn on_exit(&mut self) {
        self.modeler.close();
    }
}
