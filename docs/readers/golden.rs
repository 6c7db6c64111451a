// Read a golden dataset in Rust, as doubles from decimals: rustc -O golden.rs && ./golden data/golden/paris
use std::{env, fs, process};

/// The rows of a table without its header, each number rounded to the nearest double.
fn table(text: &str) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect();
    text.lines().skip(1).map(numbers).collect()
}

/// The bound of a column, found in what stands below "bounds" in the manifest: grid first, then transits.
fn bound<'a>(bounds: &'a str, column: &str) -> &'a str {
    let key = format!("\"{column}\": \"");
    let start = bounds.find(&key).expect("a bound") + key.len();
    bounds[start..].split('"').next().expect("a text")
}

fn main() {
    let folder = env::args().nth(1).unwrap_or_else(|| ".".into());
    let text = |name: &str| fs::read_to_string(format!("{folder}/{name}"));
    let (Ok(grid), Ok(manifest)) = (text("grid.csv"), text("manifest.json")) else {
        eprintln!("{folder}: no golden dataset");
        process::exit(2);
    };
    let bounds = manifest.split("\"bounds\"").nth(1).expect("bounds");
    let rows = table(&grid);
    let last = rows.last().expect("rows");
    println!("grid {}\nt {}", rows.len(), last[0]);
    for (i, column) in ["x", "y", "z", "vx", "vy", "vz"].iter().enumerate() {
        println!("{column} {} {}", last[i + 1], bound(bounds, column));
    }
    if let Ok(transits) = text("transits.csv") {
        let rows = table(&transits); // k,t,direction,x,y,z,vy,ax,bound
        let largest = rows.iter().map(|row| row[8]).fold(0.0, f64::max);
        println!("transits {} {largest:e}", rows.len());
    }
}
