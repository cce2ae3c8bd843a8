/* Names and numbers as the page writes them. */

export const ATTRIBUTE_NAMES = {
  task: "Task", accuracy: "Accuracy class", error: "Error addressed", detector: "Detector",
  mask: "Mask", model: "Calibration model", extractor: "Feature extractor",
  model_category: "Model family", extractor_family: "Extractor family", "offline/online": "Calibration",
  accuracy_deg: "Published accuracy", accuracy_kind: "Kind of that accuracy",
  precision_deg: "Published precision", precision_kind: "Kind of that precision", fov_deg: "Field of view",
};

const WITHOUT = {
  mask: "no mask", extractor: "no feature extraction", extractor_family: "no feature extraction",
  model: "no calibration model", model_category: "no calibration model", error: "no error named",
};
/** A value as it is written: the survey's "None" says of what there is none. */
export const worded = (attribute, value) => (value === "None" ? WITHOUT[attribute] ?? value : value);

/** A count, or a sum of fractions of studies. */
export const amount = (value) => (Number.isInteger(value) ? String(value) : value.toFixed(1));
export const plural = (n, one, many = `${one}s`) => `${n} ${n === 1 ? one : many}`;

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

  /** Family of a value; a value without a family is its own. */
  family(attribute, value) {
    return this.entries.get(`${attribute}:${value}`)?.category || value;
  }

  inFamily(attribute, family) {
    return this.values(attribute).filter((e) => (e.category || e.value) === family).map((e) => e.value);
  }
}
