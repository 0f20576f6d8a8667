// The solid in its looks, and lines. Colours come and go as sRGB values.

struct Uniforms {
    clip_from_world: mat4x4f,
    eye: vec4f,
    // Where the light comes from; w is the sine of the lean from which on it is tinted.
    key: vec4f,
    background: vec4f,
    // The size of the picture, in x and y.
    pixels: vec4f,
}

@group(0) @binding(0) var<uniform> u: Uniforms;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec4f,
}

@vertex
fn solid(@location(0) position: vec3f, @location(1) normal: vec3f, @location(2) color: vec4f) -> Corner {
    return Corner(u.clip_from_world * vec4f(position, 1.0), position, normal, color);
}

struct End {
    @builtin(position) clip: vec4f,
    @location(0) color: vec4f,
}

// The end of a line, or the place on it nearest to this end that is before the eye.
fn before_eye(end: vec4f, other: vec4f) -> vec4f {
    let near = 1e-3;
    if end.w >= near || other.w <= end.w {
        return end;
    }
    return mix(end, other, (near - end.w) / (other.w - end.w));
}

// One of the four corners of a line as a strip, so many pixels wide.
@vertex
fn line(
    @builtin(vertex_index) corner: u32,
    @location(0) first: vec3f,
    @location(1) last: vec3f,
    @location(2) color: vec4f,
    @location(3) width: f32,
) -> End {
    let first_clip = u.clip_from_world * vec4f(first, 1.0);
    let last_clip = u.clip_from_world * vec4f(last, 1.0);
    let a = before_eye(first_clip, last_clip);
    let b = before_eye(last_clip, first_clip);
    let along = (b.xy / b.w - a.xy / a.w) * u.pixels.xy;
    let across = vec2f(-along.y, along.x) / max(length(along), 1e-6);
    let side = select(-1.0, 1.0, (corner & 2u) != 0u);
    var clip = select(a, b, (corner & 1u) != 0u);
    clip += vec4f(across * (side * width) / u.pixels.xy * clip.w, 0.0, 0.0);
    return End(clip, color);
}

@fragment
fn ink(end: End) -> @location(0) vec4f {
    return end.color;
}

fn linear(c: vec3f) -> vec3f {
    return pow(c, vec3f(2.2));
}

fn encoded(c: vec3f) -> vec3f {
    return pow(clamp(c, vec3f(0.0), vec3f(1.0)), vec3f(1.0 / 2.2));
}

fn toward_eye(world: vec3f) -> vec3f {
    if u.eye.w > 0.5 {
        return normalize(u.eye.xyz - world);
    }
    return u.eye.xyz;
}

// Light from the key, from the sky and from the ground.
fn light(n: vec3f) -> f32 {
    let key = max(dot(n, u.key.xyz), 0.0);
    return 0.62 * key + 0.30 + 0.10 * n.z;
}

// The colour, tinted and hatched where it leans out too far: orange, which eyes that see no red or green tell from
// stone, and stripes for eyes that see no colours.
fn tinted(corner: Corner, n: vec3f) -> vec3f {
    let color = linear(corner.color.rgb);
    let lean = -n.z;
    if lean < u.key.w || corner.world.z < 0.05 {
        return color;
    }
    let stripe = fract((corner.clip.x + corner.clip.y) / 9.0);
    let over = linear(vec3f(0.90, 0.42, 0.0));
    return mix(over, 0.45 * over, step(0.7, stripe));
}

@fragment
fn shaded(corner: Corner) -> @location(0) vec4f {
    let n = normalize(corner.normal);
    let v = toward_eye(corner.world);
    let gleam = 0.12 * pow(max(dot(n, normalize(u.key.xyz + v)), 0.0), 24.0);
    return vec4f(encoded(tinted(corner, n) * light(n) + gleam), 1.0);
}

@fragment
fn glass(corner: Corner) -> @location(0) vec4f {
    let n = normalize(corner.normal);
    let rim = 1.0 - abs(dot(n, toward_eye(corner.world)));
    return vec4f(encoded(tinted(corner, n) * light(n)), 0.18 + 0.6 * rim * rim);
}

@fragment
fn x_ray(corner: Corner) -> @location(0) vec4f {
    let n = normalize(corner.normal);
    let rim = 1.0 - abs(dot(n, toward_eye(corner.world)));
    let ink = vec3f(1.0) - u.background.rgb;
    return vec4f(mix(ink, corner.color.rgb, 0.5), pow(rim, 4.0) * 0.9 + 0.03);
}

fn noise(cell: vec2f) -> vec2f {
    let p = vec2f(dot(cell, vec2f(127.1, 311.7)), dot(cell, vec2f(269.5, 183.3)));
    return fract(sin(p) * 43758.5453);
}

// Dots of ink on paper, one in each cell of the screen at most, and more cells with one the darker it is.
@fragment
fn stipple(corner: Corner) -> @location(0) vec4f {
    let n = normalize(corner.normal);
    let rim = 1.0 - abs(dot(n, toward_eye(corner.world)));
    let tone = light(n) * (1.0 - smoothstep(0.72, 0.95, rim));
    let size = 3.6;
    let cell = floor(corner.clip.xy / size);
    let random = noise(cell);
    let middle = (cell + 0.25 + 0.5 * random) * size;
    let near = distance(corner.clip.xy, middle);
    let dark = clamp(1.15 - 1.25 * tone, 0.0, 1.0);
    let wanted = step(fract(random.x + 0.618 * random.y), dark);
    let dot = wanted * (1.0 - smoothstep(0.8, 1.5, near));
    let edge = smoothstep(0.80, 0.92, rim);
    let paper = vec3f(0.985, 0.975, 0.95);
    return vec4f(mix(paper, vec3f(0.08), max(dot, edge)), 1.0);
}
