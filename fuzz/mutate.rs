//! Turns bytes into a changed GLB file: most random bytes are no JSON, and most random JSON is no
//! glTF, so random changes of a good file get further than both.

use serde_json::{Map, Value, json};

/// Random decisions out of the fuzzer's bytes; zeros when they are used up.
struct Choices<'a>(&'a [u8]);

impl Choices<'_> {
    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    fn below(&mut self, count: usize) -> usize {
        let number = usize::from(self.byte()) << 8 | usize::from(self.byte());
        number % count.max(1)
    }
}

/// `file` with the changes that `data` asks for.
pub fn glb(file: &[u8], data: &[u8]) -> Vec<u8> {
    let (mut json, mut binary) = split(file);
    let mut choices = Choices(data);
    for _ in 0..=choices.byte() % 8 {
        change(&mut json, &mut choices);
    }
    for _ in 0..choices.byte() % 4 {
        let at = choices.below(binary.len());
        for _ in 0..choices.byte() % 8 {
            let value = choices.byte();
            let end = binary.len();
            binary[(at + usize::from(choices.byte() % 16)).min(end - 1)] = value;
        }
    }
    join(&json, &binary)
}

fn split(file: &[u8]) -> (Value, Vec<u8>) {
    let word = |at: usize| u32::from_le_bytes([file[at], file[at + 1], file[at + 2], file[at + 3]]);
    let length = word(12) as usize;
    let json = serde_json::from_slice(&file[20..20 + length]).expect("the seed is JSON");
    (json, file[28 + length..].to_vec())
}

fn join(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    for (kind, chunk) in [(b"JSON", json.as_slice()), (b"BIN\0", binary)] {
        if kind == b"JSON" {
            file.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
        }
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// Changes one entry of the document.
fn change(json: &mut Value, choices: &mut Choices<'_>) {
    let mut paths = Vec::new();
    collect(json, String::new(), &mut paths);
    let path = paths[choices.below(paths.len())].clone();
    let Some(other) = json.pointer(&paths[choices.below(paths.len())]).cloned() else { return };
    let Some(value) = json.pointer_mut(&path) else { return };
    match choices.byte() % 8 {
        0 => *value = other,
        1 => *value = interesting(choices),
        2 | 3 => nudge(value, choices),
        4 => match value {
            Value::Array(list) => list.push(other),
            Value::Object(object) => drop(object.insert("index".to_owned(), other)),
            _ => *value = json!([other]),
        },
        5 => {
            // Without one of its parts.
            match value {
                Value::Array(list) if !list.is_empty() => {
                    drop(list.remove(choices.below(list.len())));
                }
                Value::Object(object) => remove(object, choices),
                _ => *value = Value::Null,
            }
        }
        6 => match value {
            Value::Array(list) => {
                let copies = list.clone();
                list.extend(copies);
            }
            _ => *value = interesting(choices),
        },
        _ => {
            if let Value::Array(list) = value {
                list.reverse();
            } else {
                nudge(value, choices);
            }
        }
    }
}

fn collect(value: &Value, path: String, paths: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                collect(value, format!("{path}/{key}"), paths);
            }
        }
        Value::Array(list) => {
            for (i, value) in list.iter().enumerate().take(64) {
                collect(value, format!("{path}/{i}"), paths);
            }
        }
        _ => {}
    }
    if !path.is_empty() {
        paths.push(path);
    }
}

fn remove(object: &mut Map<String, Value>, choices: &mut Choices<'_>) {
    let key = object.keys().nth(choices.below(object.len())).cloned();
    if let Some(key) = key {
        object.remove(&key);
    }
}

/// A number near the one that is there.
fn nudge(value: &mut Value, choices: &mut Choices<'_>) {
    let step = i64::from(choices.byte() as i8);
    if let Some(number) = value.as_i64() {
        *value = json!(number.saturating_add(step));
    } else if let Some(number) = value.as_f64() {
        *value = json!(number * 2.0_f64.powi(step as i32 / 4));
    } else {
        *value = interesting(choices);
    }
}

/// A value that programs often mishandle.
fn interesting(choices: &mut Choices<'_>) -> Value {
    let all = [
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(-1),
        json!(127),
        json!(255),
        json!(65535),
        json!(2_147_483_647_u32),
        json!(4_294_967_295_u32),
        json!(18_446_744_073_709_551_615_u64),
        json!(0.0),
        json!(-0.0),
        json!(1e-45),
        json!(1e-300),
        json!(3.4e38),
        json!(1e300),
        json!(-1e38),
        json!(5120),
        json!(5121),
        json!(5122),
        json!(5123),
        json!(5125),
        json!(5126),
        json!("SCALAR"),
        json!("VEC2"),
        json!("VEC3"),
        json!("VEC4"),
        json!("MAT4"),
        json!("BLEND"),
        json!("MASK"),
        json!("CUBICSPLINE"),
        json!("STEP"),
        json!("weights"),
        json!("translation"),
        json!("rotation"),
        json!("scale"),
        json!("data.bin"),
        json!("../x"),
        json!("data:application/octet-stream;base64,AAAAAAAAAAAAAAAA"),
        json!("image/ktx2"),
        json!(true),
        json!(false),
        json!(null),
        json!([]),
        json!({}),
        json!(""),
        json!([0, 0, 0]),
        json!([0, 0, 0, 0]),
        json!([1, 1, 1]),
        json!([-1, 1, 1]),
        json!([0, 0, 0, 1]),
        json!({ "index": 0 }),
        json!({ "index": 0, "texCoord": 1 }),
    ];
    all[choices.below(all.len())].clone()
}
