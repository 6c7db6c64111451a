// Evaluate a golden function in Rust: rustc -O function.rs && ./function FOLDER 17.25 3600
// Prints t, x, y, z, vx, vy, vz for each time; docs/format.md specifies the files and every operation.
use std::convert::TryInto;
use std::{env, fs};

fn from_hex(text: &str) -> f64 {
    // "0x1.8p+3"
    let (digits, exponent) = text[2..].split_once('p').expect("a hexfloat");
    let (whole, part) = digits.split_once('.').expect("a hexfloat");
    let mantissa = u64::from_str_radix(&format!("{whole}{part}"), 16).expect("hexadecimal digits") as f64;
    let power: i32 = exponent.parse().expect("an exponent");
    mantissa * 2f64.powi(power / 2) * 2f64.powi(power - power / 2 - 4 * part.len() as i32)
}

fn value<'a>(json: &'a str, key: &str) -> &'a str {
    // what stands after "key":, up to the next key
    let (_, rest) = json.split_once(&format!("\"{key}\": ")).expect(key);
    rest.split_once("\": ").map_or(rest, |(before, _)| before)
}

fn quoted(text: &str) -> Vec<f64> {
    text.split('"').filter(|word| word.starts_with("0x")).map(from_hex).collect()
}

fn main() {
    let words: Vec<String> = env::args().collect();
    let json = fs::read_to_string(format!("{}/function.json", words[1])).expect("function.json");
    let bytes = fs::read(format!("{}/function.f64", words[1])).expect("function.f64");
    let c: Vec<f64> = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let digits = value(&json, "degree").split(',').next().unwrap();
    let (degree, times): (usize, _) = (digits.trim().parse().expect("degree"), quoted(value(&json, "times")));
    let square = quoted(value(&json, "length_squared")).first().copied();
    let (series, last) = (if square.is_some() { 2 } else { 3 }, times.len() - 1);
    for word in &words[2..] {
        let t: f64 = word.parse().expect("a time");
        assert!(t >= 0.0 && t <= times[last], "{t}: not within 0 to {} s", times[last]);
        let piece = (times.partition_point(|end| *end <= t) - 1).min(last - 1);
        let (a, b) = (times[piece], times[piece + 1]);
        let w = b - a;
        let u = ((t - a) - (b - t)) / w;
        let y = u + u;
        let mut state = [0.0; 6];
        for i in 0..series {
            let k = &c[(piece * series + i) * (degree + 1)..];
            let (mut b1, mut b2, mut d1, mut d2) = (0.0, 0.0, 0.0, 0.0);
            for j in (1..=degree).rev() {
                (b1, b2) = ((y * b1 - b2) + k[j], b1);
                (d1, d2) = ((y * d1 - d2) + j as f64 * k[j], d1);
            }
            state[i] = (u * b1 - b2) + k[0];
            state[i + 3] = (d1 + d1) / w;
        }
        if let Some(l2) = square {
            let (x, y) = (state[0], state[1]);
            state[2] = -(l2 - (x * x + y * y)).sqrt();
            state[5] = -(x * state[3] + y * state[4]) / state[2];
        }
        let printed: Vec<String> = state.iter().map(|number| format!("{number:e}")).collect();
        println!("{t:e} {}", printed.join(" "));
    }
}
