// The solid in its looks, and lines. Colours come and go as sRGB values.

struct Uniforms {
    clip_from_world: mat4x4f,
    eye: vec4f,
    // Where the light comes from; w is the sine of the lean from which on it is tinted.
    key: vec4f,
    background: vec4f,
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

@vertex
fn line(@location(0) position: vec3f, @location(1) color: vec4f) -> End {
    return End(u.clip_from_world * vec4f(position, 1.0), color);
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
