//! The window's look: quiet dark greys, so that the picture stands out, and one warm colour for
//! active items.

use egui::{Color32, Context, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Visuals, vec2};

/// Colour of active and selected items.
pub const ACCENT: Color32 = Color32::from_rgb(0xf2, 0xa9, 0x3b);
/// Background of active and selected items.
pub const ACCENT_DARK: Color32 = Color32::from_rgb(0x6e, 0x4c, 0x16);
/// Colour of errors.
pub const ERROR: Color32 = Color32::from_rgb(0xff, 0x7b, 0x72);
/// Background of panels.
pub const PANEL: Color32 = Color32::from_rgb(0x20, 0x22, 0x26);
/// Background of the picture and of fields.
pub const DEEP: Color32 = Color32::from_rgb(0x15, 0x16, 0x19);
/// Ordinary text.
pub const TEXT: Color32 = Color32::from_rgb(0xd4, 0xd6, 0xda);
/// Explanatory text.
pub const WEAK: Color32 = Color32::from_rgb(0x9a, 0x9e, 0xa6);
/// Colours of the x, y and z axes.
pub const AXES: [Color32; 3] = [
    Color32::from_rgb(0xef, 0x5b, 0x5b),
    Color32::from_rgb(0x6c, 0xc4, 0x5a),
    Color32::from_rgb(0x4f, 0x9d, 0xf7),
];
/// Colours of stages in plots, which colour-blind readers can tell apart on a dark background
/// (after Okabe and Ito 2008).
pub const STAGES: [Color32; 8] = [
    Color32::from_rgb(0x8c, 0x8c, 0x8c),
    Color32::from_rgb(0xcc, 0x79, 0xa7),
    Color32::from_rgb(0xf0, 0xe4, 0x42),
    Color32::from_rgb(0x56, 0xb4, 0xe9),
    Color32::from_rgb(0x00, 0x9e, 0x73),
    Color32::from_rgb(0xe6, 0x9f, 0x00),
    Color32::from_rgb(0x00, 0x72, 0xb2),
    Color32::from_rgb(0xd5, 0x5e, 0x00),
];

/// Applies the theme to a context.
pub fn apply(context: &Context) {
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        style.visuals = visuals();
        let sizes = [
            (TextStyle::Heading, 14.0, FontFamily::Proportional),
            (TextStyle::Body, 12.5, FontFamily::Proportional),
            (TextStyle::Button, 12.5, FontFamily::Proportional),
            (TextStyle::Small, 10.5, FontFamily::Proportional),
            (TextStyle::Monospace, 12.0, FontFamily::Monospace),
        ];
        style.text_styles = sizes
            .into_iter()
            .map(|(text, size, family)| (text, FontId::new(size, family)))
            .collect();
        style.spacing.item_spacing = vec2(6.0, 4.0);
        style.spacing.button_padding = vec2(6.0, 2.0);
        style.spacing.interact_size.y = 18.0;
        style.spacing.indent = 8.0;
        style.spacing.icon_width = 12.0;
        style.spacing.icon_spacing = 5.0;
        style.spacing.icon_width_inner = 7.0;
        style.spacing.tooltip_width = 320.0;
        style.spacing.scroll = egui::style::ScrollStyle::solid();
        style.spacing.scroll.bar_width = 7.0;
    });
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.override_text_color = None;
    visuals.panel_fill = PANEL;
    visuals.window_fill = Color32::from_rgb(0x27, 0x29, 0x2e);
    visuals.window_stroke = Stroke::new(1.0, Color32::from_rgb(0x3a, 0x3d, 0x44));
    visuals.extreme_bg_color = DEEP;
    visuals.faint_bg_color = Color32::from_rgb(0x26, 0x28, 0x2d);
    visuals.error_fg_color = ERROR;
    visuals.hyperlink_color = ACCENT;
    visuals.selection.bg_fill = ACCENT_DARK;
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(0xff, 0xdd, 0xa6));
    visuals.slider_trailing_fill = true;
    visuals.indent_has_left_vline = false;
    visuals.window_corner_radius = CornerRadius::same(6);
    visuals.menu_corner_radius = CornerRadius::same(5);
    let widgets = &mut visuals.widgets;
    let grey = |level: u8| Color32::from_rgb(level, level + 1, level + 4);
    widgets.noninteractive.fg_stroke.color = TEXT;
    widgets.noninteractive.bg_stroke.color = grey(0x33);
    for (widget, fill, line) in [
        (&mut widgets.inactive, grey(0x31), TEXT),
        (&mut widgets.hovered, grey(0x3d), Color32::WHITE),
        (&mut widgets.active, grey(0x48), Color32::WHITE),
        (&mut widgets.open, grey(0x36), Color32::WHITE),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.fg_stroke.color = line;
        widget.corner_radius = CornerRadius::same(3);
        widget.expansion = 0.0;
    }
    widgets.hovered.bg_stroke = Stroke::new(1.0, grey(0x55));
    widgets.active.bg_stroke = Stroke::new(1.0, ACCENT);
    visuals
}
