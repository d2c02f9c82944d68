//! Studies as a whole: the content of a file, and that the result is the same bytes whatever happens on the way.

use super::*;
use std::fs;

/// Two machines, two numbers; a belt that is too soft for a place that an H-bot does not reach.
const STUDY: &str = "\
compute = [\"stiffness\", \"modes\"]
machines = [\"corehbot\", \"hbot\"]
at = [45.0, 200.0]
method = \"latin-hypercube\"
samples = 4
seed = 7
[vary]
belt_EA_N = { from = 20000, to = 56000 }
head_mass_kg = { from = 0.4, to = 0.8 }
";

fn study(folder: &Path, text: &str) -> Result<Study> {
    let file = folder.join("s.toml");
    fs::write(&file, text)?;
    read::read(&file)
}

/// The identity of a study, on a platform.
fn identity_on(file: &Path, platform: [&str; 3]) -> String {
    let form: form::StudyToml = toml::from_str(&fs::read_to_string(file).unwrap()).unwrap();
    let (keys, _) = check::design(&form).unwrap();
    read::identity(&form, &keys, &[], platform).unwrap()
}

fn csv(study: &Study, samples: &[Sample]) -> String {
    let mut bytes = Vec::new();
    table::write(&mut bytes, study, samples).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// All samples, with a journal, as a run from its begin to its end.
fn whole(study: &Study, output: &Path, jobs: usize) -> (String, String) {
    let (mut journal, kept) = Journal::open(output, study).unwrap();
    let samples = compute(study, Some(&mut journal), kept, Some(jobs), &Stop::default()).unwrap();
    let written = fs::read_to_string(&journal.path).unwrap();
    journal.remove().unwrap();
    (csv(study, &samples), written)
}

#[test]
fn a_journal_that_was_cut_at_any_byte_leads_to_the_same_result() {
    let folder = tempfile::tempdir().unwrap();
    let (study, output) = (study(folder.path(), STUDY).unwrap(), folder.path().join("s.csv"));
    let (table, journal) = whole(&study, &output, 1);
    assert_eq!(journal.lines().count(), 1 + 8);
    for cut in 0..=journal.len() {
        fs::write(folder.path().join("s.csv.journal"), &journal[..cut]).unwrap();
        let (opened, kept) = Journal::open(&output, &study).unwrap();
        // The head, and as many samples as there are whole lines.
        assert_eq!(kept.len(), journal[..cut].matches('\n').count().saturating_sub(1), "cut at {cut}");
        drop(opened);
        let (again, rewritten) = whole(&study, &output, 1);
        assert_eq!(again, table, "cut at {cut}");
        assert_eq!(rewritten, journal, "cut at {cut}");
    }
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let text = STUDY.replace("samples = 4", "samples = 40");
    let (study, output) = (study(folder.path(), &text).unwrap(), folder.path().join("s.csv"));
    let [one, two, seven] = [1, 2, 7].map(|jobs| whole(&study, &output, jobs).0);
    assert!(one == two && one == seven);
    assert_eq!(one.lines().count(), 1 + 80);
}

#[test]
fn a_line_that_was_damaged_is_computed_again_and_one_that_came_twice_counts_once() {
    let folder = tempfile::tempdir().unwrap();
    let (study, output) = (study(folder.path(), STUDY).unwrap(), folder.path().join("s.csv"));
    let (table, journal) = whole(&study, &output, 1);
    let lines: Vec<&str> = journal.lines().collect();
    let damaged = lines[3].replacen("\"sample\":2", "\"sample\":5", 1);
    let foreign = lines[4].replacen(&study.identity, "0123456789abcdef", 1);
    let text = [lines[0], lines[1], lines[2], lines[2], &damaged, &foreign, "", "{}", lines[8], ""].join("\n");
    fs::write(folder.path().join("s.csv.journal"), text).unwrap();
    let (opened, kept) = Journal::open(&output, &study).unwrap();
    assert_eq!(kept.iter().map(|sample| sample.number).collect::<Vec<_>>(), [0, 1, 1, 7]);
    drop(opened);
    assert_eq!(whole(&study, &output, 2).0, table);
}

#[test]
fn what_is_played_is_read_when_a_sample_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let text = "compute = [\"run\"]\nmethod = \"grid\"\n[vary]\npreload_N = [30, 40, 50]\n[run]\nfile = \"s.gcode\"\n";
    // An emergency stop: the file gives no steps.
    fs::write(folder.path().join("s.gcode"), "M112\n").unwrap();
    let (study, output) = (study(folder.path(), text).unwrap(), folder.path().join("s.csv"));
    assert!(line::head(&study).unwrap().contains("\"samples\":3"));
    let keep = |numbers: &[usize]| {
        let (mut journal, _) = Journal::open(&output, &study).unwrap();
        for number in numbers {
            let sample = Sample { number: *number, outcome: Ok(vec![Some(1.0); 6]) };
            journal.append(&line::of_sample(&study, &sample).unwrap()).unwrap();
        }
    };
    keep(&[2, 0]);
    let all = || {
        let (mut journal, kept) = Journal::open(&output, &study).unwrap();
        let samples = compute(&study, Some(&mut journal), kept, Some(1), &Stop::default());
        journal.remove_if_empty().unwrap();
        samples
    };
    let why = format!("{:#}", all().unwrap_err());
    assert!(why.contains("s.gcode: the print failed"), "{why}");
    keep(&[1]);
    assert_eq!(all().unwrap().iter().map(|sample| sample.number).collect::<Vec<_>>(), [0, 1, 2]);
    // A journal without samples goes, one with some stays.
    let journal = folder.path().join("s.csv.journal");
    assert!(journal.exists());
    fs::remove_file(&journal).unwrap();
    assert!(all().is_err() && !journal.exists());
}

#[test]
fn the_journal_of_another_study_and_what_is_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (one, output) = (study(folder.path(), STUDY).unwrap(), folder.path().join("s.csv"));
    let (_, journal) = whole(&one, &output, 1);
    let path = folder.path().join("s.csv.journal");
    let refused = |study: &Study, text: &str| {
        fs::write(&path, text).unwrap();
        let error = format!("{:#}", Journal::open(&output, study).unwrap_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), text, "it is not to be touched");
        error
    };
    let changes = [("seed = 7", "seed = 8"), ("0.8 }", "0.9 }"), ("[vary]", "[twin]\npreload_N = 41\n[vary]")];
    for (from, to) in changes {
        let other = study(folder.path(), &STUDY.replace(from, to)).unwrap();
        assert!(refused(&other, &journal).contains("is of another study"), "{to}");
    }
    // Another kind of machine rounds in another way.
    let mut foreign = study(folder.path(), STUDY).unwrap();
    foreign.identity = identity_on(&folder.path().join("s.toml"), ["riscv64", "linux", "gnu"]);
    assert!(refused(&foreign, &journal).contains("on another kind of machine"));
    assert_eq!(identity_on(&folder.path().join("s.toml"), read::PLATFORM), one.identity);
    // Comments and blanks make no other study.
    assert_eq!(study(folder.path(), &format!("# again\n{STUDY}")).unwrap().identity, one.identity);
    assert!(refused(&one, "sample,machine\n").contains("is not a journal"));
    assert!(refused(&one, "my diary").contains("is not a journal"));
    fs::write(&path, &journal).unwrap();
    let first = Journal::open(&output, &one).unwrap();
    assert!(format!("{:#}", Journal::open(&output, &one).unwrap_err()).contains("another process"));
    drop(first);
}

#[test]
fn the_order_of_the_numbers_is_that_of_the_file_and_the_machines_change_fastest() {
    let folder = tempfile::tempdir().unwrap();
    let grid = "compute = [\"stiffness\"]\nmachines = [\"corehbot\", \"corexy\"]\nmethod = \"grid\"\n\
                [vary]\npreload_N = [30, 40]\nbelt_EA_N = { from = 20000, to = 40000, count = 3 }\n";
    let study = study(folder.path(), grid).unwrap();
    assert_eq!((study.samples, &study.keys[..]), (12, &["preload_N".to_owned(), "belt_EA_N".to_owned()][..]));
    let points: Vec<_> = (0..12).map(|i| study.point(i).unwrap()).map(|p| (p.machine.key(), p.values)).collect();
    assert_eq!(points[0], ("corehbot", vec![30.0, 20_000.0]));
    assert_eq!(points[1], ("corexy", vec![30.0, 20_000.0]));
    assert_eq!(points[2], ("corehbot", vec![30.0, 30_000.0]));
    assert_eq!(points[11], ("corexy", vec![40.0, 40_000.0]));
    // The stiffness with belts of EA = 30,000 N, times EA (docs/research/twin.md).
    let samples = compute(&study, None, Vec::new(), None, &Stop::default()).unwrap();
    let kxx = |i: usize| samples[i].outcome.as_ref().unwrap()[0].unwrap();
    assert!((kxx(2) - 287.563).abs() < 0.01 && (kxx(4) / kxx(0) - 2.0).abs() < 1e-9, "{} {}", kxx(2), kxx(4));
}

#[test]
fn a_sample_without_figures_says_why_and_the_others_have_theirs() {
    let folder = tempfile::tempdir().unwrap();
    let (study, output) = (study(folder.path(), STUDY).unwrap(), folder.path().join("s.csv"));
    let rows: Vec<String> = whole(&study, &output, 1).0.lines().skip(1).map(str::to_owned).collect();
    assert!(rows[0].starts_with("0,corehbot,") && rows[0].ends_with(','), "{}", rows[0]);
    assert!(rows[1].ends_with(",,,,,,,\"the tool does not reach (45.0, 200.0)\""), "{}", rows[1]);
    assert!(rows.iter().all(|row| row.split("\"the").next().unwrap().matches(',').count() == 10), "{rows:?}");
}

#[test]
fn of_a_grid_of_places_the_worst_counts() {
    let folder = tempfile::tempdir().unwrap();
    let text = "compute = [\"stiffness\", \"modes\", \"push\"]\nmachines = [\"corexy\"]\nworst_of = [3, 3]\n\
                method = \"grid\"\n[push]\nforce_N = [5, 0]\n[vary]\nbelt_EA_N = [30000]\n";
    let worst = study(folder.path(), text).unwrap().sample(0, &Stop::default()).unwrap().outcome.unwrap();
    let at = |x: f64, y: f64| {
        let one = text.replace("worst_of = [3, 3]", &format!("at = [{x:?}, {y:?}]"));
        study(folder.path(), &one).unwrap().sample(0, &Stop::default()).unwrap().outcome.unwrap()
    };
    let reach = corehbot_twin::geometry::workspace(corehbot_twin::routing::Machine::CoreXy, &Default::default());
    let middle = reach.centre();
    let places = [reach.x[0], middle.x, reach.x[1]].map(|x| [reach.y[0], middle.y, reach.y[1]].map(|y| at(x, y)));
    let all = |i: usize| places.iter().flatten().map(move |figures| figures[i].unwrap());
    for least in [0, 1, 3, 4, 5] {
        assert_eq!(worst[least], all(least).reduce(f64::min), "column {least}");
    }
    assert_eq!(worst[6].map(f64::abs), all(6).map(f64::abs).reduce(f64::max));
}

/// The study in docs/research/twin.md has every key; its queries get the same answers as from the twin's own commands.
#[test]
fn the_study_in_the_documentation_is_one() {
    use corehbot_twin::queries::{Setup, limits::Limits, push::Push, resonance::Resonance};
    use corehbot_twin::{params::Params, routing::Machine};
    let docs = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/research/twin.md")).unwrap();
    let text = docs.split("```toml\n").map(|rest| rest.split("```").next().unwrap());
    let text = text.into_iter().find(|text| text.starts_with("compute")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("print.gcode"), "G1 X110 F6000\nM400\n").unwrap();
    let study = study(folder.path(), &text.replace("[7, 7]", "[3, 3]")).unwrap();
    assert_eq!((study.samples, study.figures().count()), (400, 4 + 2 + 3 + 11 + 10 + 6));
    assert!(study.sample(1, &Stop::default()).is_none(), "nothing is played before it was loaded");
    study.load(&Stop::default()).unwrap();
    let sample = study.sample(1, &Stop::default()).unwrap().outcome.unwrap();
    let figure = |name| sample[study.figures().position(|known| known == name).unwrap()].unwrap();
    let values = study.point(1).unwrap().values;
    let params = Params {
        belt_ea_n: values[0].into(),
        holding_torque_nm: values[1],
        preload_n: 50.0.into(),
        ..Params::default()
    };
    let reach = corehbot_twin::geometry::workspace(Machine::CoreXy, &params);
    let freedom = corehbot_questions::setup::ModelArg::Rotors.freedom();
    let setup = |tool| Setup { machine: Machine::CoreXy, params: params.clone(), tool, freedom };
    let limits = Limits::new(&setup(reach.centre()), 0.025, 0.5).unwrap();
    assert_eq!(figure("y_slack_acceleration_mm_s2"), limits.y.slack_acceleration_mm_s2);
    assert_eq!(Some(figure("yaw_error_um_per_m_s2")), limits.yaw_error_um_per_m_s2);
    let resonance = Resonance::new(&setup(reach.centre()), 3, 3).unwrap();
    assert_eq!([figure("y_lowest_Hz"), figure("y_highest_Hz")], resonance.y.band_hz);
    let pushed = Push::new(&setup(reach.centre()), [5.0, 0.0]).unwrap().strain.dx_mm;
    assert!(figure("push_dx_mm") >= pushed && figure("push_dx_mm") < 3.0 * pushed, "{pushed}");
    assert!(figure("slips") == 0.0 && figure("tension_min_N") < 50.0 && figure("torque_margin") < 1.0);
}

/// A key that a study leaves out has the default of the query's own command.
#[test]
fn what_is_left_out_is_as_the_commands_have_it() {
    use clap::{Command, ValueEnum as _};
    use corehbot_questions::setup::{ModelArg, parse_grid};
    use form::{LimitsToml, QueryToml, ResonanceToml};
    let default = |command: &Command, id: &str| {
        let arg = command.get_arguments().find(|arg| arg.get_id() == id).unwrap().clone();
        arg.get_default_values()[0].to_str().unwrap().to_owned()
    };
    let owners = corehbot_cli::cli::command();
    let own = crate::cli::command();
    let twin = |name: &str| owners.find_subcommand("twin").unwrap().find_subcommand(name).unwrap();
    let commands = [
        (QueryToml::Stiffness, twin("stiffness")),
        (QueryToml::Modes, twin("modes")),
        (QueryToml::Push, own.find_subcommand("push").unwrap()),
        (QueryToml::Limits, twin("limits")),
        (QueryToml::Resonance, twin("resonance")),
    ];
    for (query, command) in commands {
        let word = default(command, "model");
        assert_eq!(read::model(query).freedom(), ModelArg::from_str(&word, false).unwrap().freedom(), "{word}");
    }
    let number = |id| default(twin("limits"), id).parse::<f64>().unwrap();
    let LimitsToml { error_mm, torque } = LimitsToml::default();
    assert_eq!([error_mm, torque], ["error", "torque"].map(number));
    let grid = default(twin("resonance"), "grid");
    assert_eq!(ResonanceToml::default().grid, parse_grid(&grid).unwrap());
    // A study that says its model has it in all questions.
    let folder = tempfile::tempdir().unwrap();
    let text = "compute = [\"modes\", \"limits\"]\nmethod = \"grid\"\n[vary]\nbelt_EA_N = [30000]\n";
    let figures =
        |text: &str| study(folder.path(), text).unwrap().sample(0, &Stop::default()).unwrap().outcome.unwrap();
    let with = |model: &str| figures(&format!("model = \"{model}\"\n{text}"));
    let (none, reduced, rotors) = (figures(text), with("reduced"), with("rotors"));
    assert_eq!((&none[..2], &none[2..]), (&reduced[..2], &rotors[2..]));
    assert!(reduced[0] != rotors[0] && reduced[4] != rotors[4], "{reduced:?} {rotors:?}");
}

#[test]
fn the_example_of_a_study_is_one() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/cluster/study.toml");
    let study = read::read(&example).unwrap();
    assert_eq!((study.samples, study.keys.len(), study.inputs.len()), (200, 4, 2));
}

#[test]
fn what_is_wrong_with_a_study_is_said_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let said = |from: &str, to: &str| {
        assert!(STUDY.contains(from), "{from}");
        let error = study(folder.path(), &STUDY.replacen(from, to, 1)).err().map(|error| format!("{error:#}"));
        error.unwrap_or_else(|| panic!("`{to}` is taken"))
    };
    let cases = [
        ("samples = 4", "sampels = 4", "s.toml:5:1: ", "did you mean `samples`?"),
        ("belt_EA_N", "belt_EA", "s.toml:8:1: ", "did you mean `belt_EA_N`?"),
        ("from = 20000", "form = 20000", "s.toml:8:15: ", "did you mean `from`?"),
        ("\"hbot\"", "\"hbott\"", "s.toml:2:25: ", "did you mean `hbot`?"),
        ("\"modes\"", "\"mode\"", "s.toml:1:25: ", "did you mean `modes`?"),
        ("\"modes\"", "\"stiffness\"", "s.toml:1:11: ", "each only once"),
        ("\"modes\"", "\"run\"", "s.toml: ", "and a file need each other"),
        ("\"modes\"", "\"push\"", "s.toml: ", "and a force need each other"),
        ("latin-hypercube", "grid", "s.toml:5:11: ", "only a latin-hypercube"),
        ("samples = 4", "samples = 0", "s.toml:5:11: ", "1 to 1000000"),
        ("samples = 4\n", "", "s.toml: ", "samples: a latin-hypercube needs"),
        ("samples = 4", "samples = 900000", "s.toml:7:2: ", "more than 1000000"),
        ("to = 56000 }", "to = 56000, count = 3 }", "s.toml:8:1: ", "not in a count"),
        ("from = 20000", "from = -1", "s.toml:8:1: ", "belt_EA_N = -1 must be above 0"),
        ("from = 20000", "from = nan", "s.toml:8:1: ", "is not a number"),
        ("{ from = 20000, to = 56000 }", "[]", "s.toml:8:13: ", "at least one value"),
        ("{ from = 20000, to = 56000 }", "3", "s.toml:8:13: ", "a list of numbers"),
        ("at = [45.0, 200.0]", "at = [45.0]", "s.toml:3:", "length"),
        ("method", "worst_of = [3, 3]\nmethod", "s.toml:4:12: ", "not both"),
        ("at = [45.0, 200.0]", "worst_of = [1, 3]", "s.toml:3:12: ", "2 to 200"),
        ("[vary]", "[twin]\npreload_N = -1\n[vary]", "s.toml:8:13: ", "must not be below 0"),
        (
            "compute = [\"stiffness\", \"modes\"]",
            "compute = [\"run\"]\nrun = { file = \"s.toml\", begin = [nan, 0] }",
            "s.toml:2:",
            "mm from motor 1's axis, which `twin run` calls --at",
        ),
        ("[vary]", "[limits]\ntorque = 2\n[vary]", "s.toml:8:10: ", "up to 1 is legal"),
    ];
    for (from, to, place, why) in cases {
        let said = said(from, to);
        assert!(said.contains(place) && said.contains(why) && said.lines().count() == 1, "{to}: {said}");
    }
}
