/* Names and numbers as the page writes them. */

export const ATTRIBUTE_NAMES = {
  task: "Task", accuracy: "Accuracy class", error: "Error addressed", detector: "Detector",
  mask: "Mask", model: "Calibration model", extractor: "Feature extractor",
  model_category: "Model family", extractor_family: "Extractor family", "offline/online": "Calibration",
  accuracy_deg: "Published accuracy", accuracy_kind: "Kind of that accuracy",
  precision_deg: "Published precision", precision_kind: "Kind of that precision", fov_deg: "Field of view",
};

/** A unit that is not the service's own is so many times smaller: a share of 0.95 is 95 %. */
export const LIMIT_NAMES = {
  max_error_deg: { name: "Error at most", unit: "°", words: "error at most", subject: "error" },
  min_fov_deg: { name: "Field of view at least", unit: "°", words: "field of view at least", subject: "field of view" },
  min_availability: { name: "Availability at least", unit: "%", words: "availability at least", subject: "availability", smaller: 100 },
  max_latency_us: { name: "Latency at most", unit: "µs", words: "latency at most", subject: "latency" },
  bench_deg: { name: "Calibration bench error", unit: "°", words: "calibration bench error", subject: "calibration bench" },
  confidence: { name: "Confidence", unit: "%", words: "confidence over units and benches", subject: "confidence", smaller: 100 },
};

export const LIST_NAMES = {
  survive: { name: "Must tolerate", words: "must tolerate", subject: "conditions to tolerate" },
  properties: { name: "Extractor property", words: "extractor property", subject: "extractor properties" },
  exclude_needs: { name: "Without", words: "without", subject: "additional inputs" },
};

/** Inputs that a calibration may need besides the sensor readings. */
export const NEEDS = {
  rates: "body rates of a gyroscope", time: "time of each sample", temperature: "sensor temperature",
  nadir: "direction to the Earth", "magnetic-field": "magnetometer", almanac: "the Sun's direction in inertial space",
  eclipse: "whether it is in eclipse", "albedo-flag": "whether the Earth is lit",
};

/** Conditions that a sensor may have to tolerate: name in the API, and in words. */
export const HAZARDS = {
  albedo: "Earth's albedo, with clouds",
  "missing-apertures": "closed or dirty apertures",
  ageing: "end of life, dead pixels",
  temperature: "hot and cold",
  misalignment: "rotated or shifted in its mount",
  glare: "glare, ghosts, stray light",
  saturation: "over-exposure",
  spin: "rotation during the exposure",
  noise: "ten times the noise",
};

/** Properties of the survey's assessment of extractors, in the order of its table. */
export const PROPERTIES = [
  "Computationally light", "No pre-processing", "Algorithmically simple", "Pinhole Mask", "Slit Mask",
  "Other Mask", "CMOS Detector", "CCD Detector", "Other Detector", "Feature profile agnostic",
  "Feature pattern agnostic", "Multi-feature", "Feature tracking", "Blooming features",
  "Resolution scaling", "Sub-pixel resolution", "High precision", "Feature location agnostic",
  "Robust to noise", "Noise level agnostic", "Robust to missing features",
];

/** Rankings of an answer. */
export const SORTS = [["advice", "Advice"], ["support", "Studies"], ["measured", "Measurement"]];

/** Evidence by which a requirement was checked. */
export const JUDGED_ON = {
  measured: "our measurements", stated: "values stated in studies", studies: "its studies",
  advised: "the survey's advice", assessed: "the survey's assessment",
};

export const BASES = {
  "survey-table": "a mapping table of the survey",
  "authors-table": "the survey authors' own table",
  "survey-text": "the survey's text",
  "full-text": "the study's own text",
  abstract: "the study's abstract or record",
  title: "the study's title",
  inferred: "inferred from other facts about the study",
  recalled: "recalled, not checked against a source",
  unknown: "not known",
};

export const IDENTITIES = {
  confirmed: "author, year and topic confirmed on a public page",
  recalled: "bibliographic data recalled, not checked against a source",
  ambiguous: "more than one publication fits the key",
  unknown: "no publication identified for the key",
};

/** Three significant digits, never an exponent; a dash where there is no number. */
export function number(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(Number(value))) return "–";
  const x = Number(value);
  if (x === 0) return "0";
  if (Math.abs(x) >= 1000) { // all its digits would say more than is known
    return Number(x.toPrecision(digits)).toLocaleString("en-GB");
  }
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(x))));
  return x.toFixed(Math.min(decimals, 8));
}

export const degrees = (value) => (number(value) === "–" ? "–" : `${number(value)}°`);
/** A field of view: 60°, where an error would be 60.0°. */
export const wide = (value) => `${Number(value.toPrecision(4))}°`;
export const times = (value) => (number(value) === "–" ? "–" : `${number(value)}×`);

/** A limit of the service in the unit of the page; what is no number, as it stands. */
export function inUnit(name, text) {
  const { smaller = 1 } = LIMIT_NAMES[name];
  return smaller === 1 || text === "" || Number.isNaN(Number(text)) ? text : String(Number((text * smaller).toPrecision(12)));
}

/** A limit as it is typed, in the unit of the service. */
export function ofUnit(name, text) {
  const { smaller = 1 } = LIMIT_NAMES[name];
  return smaller === 1 || text === "" ? text : String(Number((text / smaller).toPrecision(12)));
}

/** A limit with its unit. */
export const limitText = (name, text) => `${inUnit(name, text)} ${LIMIT_NAMES[name].unit}`.replace(" °", "°");
/** A word of a command line. */
export const quoted = (word) => (/^[\w.+-]+$/.test(word) ? word : `'${word}'`);
export const sentence = (text) => `${text.charAt(0).toUpperCase()}${text.slice(1)}.`;

const WITHOUT = {
  mask: "no mask", extractor: "no feature extraction", extractor_family: "no feature extraction",
  model: "no calibration model", model_category: "no calibration model", error: "no error named",
};
/** A value as it is written: the survey's "None" says of what there is none. */
export const worded = (attribute, value) => (value === "None" ? WITHOUT[attribute] ?? value : value);

/** A count, or a sum of fractions of studies. */
export const amount = (value) => (Number.isInteger(value) ? String(value) : value.toFixed(1));
export const plural = (n, one, many = `${one}s`) => `${n} ${n === 1 ? one : many}`;
export const studiesCount = (n) => plural(n, "study", "studies");
export const percent = (fraction) => {
  if (fraction === null || fraction === undefined) return "–";
  return fraction === 1 ? "100 %" : `${(Math.floor(fraction * 1000) / 10).toFixed(1)} %`;
};

/** The vocabulary: names and families of the taxonomy's values. */
export class Vocabulary {
  constructor(attributes) {
    this.attributes = attributes;
    this.entries = new Map();
    for (const [attribute, values] of Object.entries(attributes)) {
      for (const entry of values) this.entries.set(`${attribute}:${entry.value}`, entry);
    }
  }

  values(attribute) {
    return this.attributes[attribute] ?? [];
  }

  name(attribute, value) {
    return this.entries.get(`${attribute}:${value}`)?.name || value;
  }

  /** Family of a value; a value without a family is its own. */
  family(attribute, value) {
    return this.entries.get(`${attribute}:${value}`)?.category || value;
  }

  inFamily(attribute, family) {
    return this.values(attribute).filter((e) => (e.category || e.value) === family).map((e) => e.value);
  }

  /** Values as the sentence says them: a whole family by its name. [[label, values, isFamily], ...] */
  gathered(attribute, values) {
    const rest = new Set(values);
    const parts = [];
    if (attribute === "model" || attribute === "extractor") {
      for (const family of new Set(this.values(attribute).map((e) => e.category || e.value))) {
        const members = this.inFamily(attribute, family);
        if (members.length > 1 && members.every((v) => rest.has(v))) {
          parts.push([`any ${family}`, members, true]);
          members.forEach((v) => rest.delete(v));
        }
      }
    }
    return [...parts, ...[...rest].map((v) => [v, [v], false])];
  }
}
