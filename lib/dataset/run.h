/* Whole runs on files, from rays, from sums that were kept, or from shards; and their files:
 * images, labels and JSON. */
#ifndef SONJECT_DATASET_RUN_H
#define SONJECT_DATASET_RUN_H

#include <jansson.h>

#include <sonject/run.h>
#include <sonject/stages.h>

#include "device/device.h"
#include "inject/checkpoints.h"
#include "inject/swath.h"

/* Share of a highlight's pixels at the image's ceiling above which that is told. */
#define CLIPPED_MUCH 0.1

/* Of the ceiling over an echo's peak, so that speckle reaches it in a few of its pixels. */
#define CEILING_ROOM_DB 3.0

#define LABEL_FORMATS ((uint32_t)(SONJECT_LABELS_YOLO | SONJECT_LABELS_VOC))

/* Injects and writes the folder's files: sonject_run. was_finished may be NULL. */
sonject_status run_scene(struct report *report, struct device_slot *slot,
                         const struct run_request *request, int *was_finished);

/* Logs what is to be known of a result besides its numbers: empty rows, noise floor, accuracy,
 * limits of models, altitudes, objects that are not seen, what full scale cuts. */
void tell_result(struct report *report, const struct scene *scene, const struct swath *swath,
                 const struct injection_result *result);

/* Traces the request's scene and writes its sums to the file: sonject_trace. */
sonject_status trace_scene(struct report *report, struct device_slot *slot,
                           const struct run_request *request, const char *file);

/* Forms the image of what was traced: sonject_form. scene: NULL for that whose text is kept. The
 * request has the folder, and what is asked of it. */
sonject_status form_scene(struct report *report, struct device_slot *slot,
                          const struct scene *scene, const sonject_form_params *params,
                          const struct run_request *request, int *was_finished);

/* Makes the result of all shards in the request's folder, whose scene they keep: sonject_merge; of
 * bands, where there are such, each in its folder. */
sonject_status merge_folder(struct report *report, struct device_slot *slot,
                            const struct run_request *request, int *was_finished);

/* Reads the scene whose text a file keeps, with the overrides of params, whose file is for the
 * message. Names of files are meant from where it was traced. calibration: the file that stands for
 * input.calibration: auto; NULL: none. scene is the caller's for scene_clear, also on failure.
 * Errors: INPUT, STORAGE, MEMORY. */
sonject_status read_traced_scene(struct report *report, const struct kept_scene *kept,
                                 const sonject_form_params *params, const char *calibration,
                                 struct scene *scene);

/* What the hydrophones hear of the scene's input, into the folder: sonject_elements_run. */
sonject_status run_elements(struct report *report, struct device_slot *slot,
                            const struct scene *scene, const sonject_run_params *params,
                            sonject_progress_function progress, void *user);

/* The scene's geometry as a text with a sample, for free(): sonject_check. */
sonject_status describe_scene(struct report *report, const struct scene *scene, char **text);

struct run_facts {
    const struct scene *scene;
    const struct swath *swath;
    const struct injection_result *result;
    const struct device *device;
    const char *scene_hash; /* of scene and input: inject/scene_hash.h */
    json_t *inputs;         /* of what that is made */
    json_t *files;          /* that were written, as file_list_add has them */
    json_t *page; /* what report.html tells besides truth: see write_layers, note_result */
    const char *image_name;
    uint32_t label_formats; /* sum of sonject_labels */
    double read_s, write_s, total_s;
    int jpeg_quality; /* that the image is coded with; 0: without loss */
};

#define REPORT_PAGE  "report.html"
#define TRUTH_DIGITS 12

/* What truth.json says; NULL where memory is out. */
json_t *truth_document(const struct run_facts *facts);

/* Each writes one file, whole or not at all. Errors: STORAGE, MEMORY. */
sonject_status write_truth(struct report *report, const struct run_facts *facts, const char *path);
sonject_status write_run(struct report *report, const struct run_facts *facts, const char *path);

/* The same of report.html, which takes facts->page and links to facts->files. */
sonject_status write_run_page(struct report *report, struct run_facts *facts, const char *path);

/* lib/dataset/report_page.html, where @DATA@ stands for what it shows. */
extern const char report_page[];

/* Writes a page that shows the data, which is released, its numbers with so many digits. Errors:
 * STORAGE, MEMORY (also where data is NULL). */
sonject_status report_page_write(struct report *report, json_t *data, size_t digits,
                                 const char *path);

/* For such data: how many values lie in each of HISTOGRAM_BINS equal parts of low...high, in the
 * outermost ones those beyond. */
#define HISTOGRAM_BINS 24
json_t *histogram_counts(const double *values, size_t count, double low, double high);

/* What of a result is a file of its own: masks are images of the swath's size, all else of its
 * patch. */
enum layer {
    LAYER_FIELD,
    LAYER_ENERGY,
    LAYER_HIGHLIGHT,
    LAYER_SHADOW,
    LAYER_LABELS, /* the numbers of objects */
    LAYER_INFLUENCE
};
#define LAYERS (LAYER_INFLUENCE + 1)

/* Errors: STORAGE, MEMORY. */
sonject_status write_layer(struct report *report, const struct run_facts *facts, enum layer layer,
                           const char *path);

/* Writes patch.tif, energy.tif, highlight.png, shadow.png, labels.png, influence.png, quicklook.png
 * and, where the result has them, energy_order_1.tif and so on into the folder, each whole or not
 * at all, lists them in facts->files, and tells facts->page of the quicklook's panels and the
 * orders' energies. Errors: STORAGE, MEMORY. */
sonject_status write_layers(struct report *report, struct run_facts *facts, const char *folder);

/* Writes coco.json, contacts.csv, and what facts->label_formats asks for, and lists them in
 * facts->files; label files of other formats that an earlier run left are removed. Errors: STORAGE,
 * MEMORY. */
sonject_status write_labels(struct report *report, struct run_facts *facts, const char *folder);

/* The formats (sum of sonject_labels) that a run.json names. */
uint32_t labels_of_document(const json_t *run);

/* Which device that is; NULL when memory is out. */
json_t *device_document(const struct device *device);

/* ---- Calibrations that scenes ask for by input.calibration: auto. */

#define CALIBRATION_NAME "calibration"

/* Makes folder/name.yaml of the scene's image, and a picture beside it, unless it is there; one
 * that was made for another image, channel, array or geometry or by another version, or was
 * changed, is made anew if it may be replaced. path gets its name. Processes that make it at the
 * same time make the same. Errors: as of sonject_calibrate. */
sonject_status scene_calibrate(struct report *report, const struct scene *scene, const char *folder,
                               const char *name, bool replaces, char path[PATH_CAPACITY]);

/* Makes the file in the request's folder and reads the scene with it; calibrated is for
 * scene_clear, also on failure. Errors: as above, and of scene_source_read. */
sonject_status calibrated_scene_read(struct report *report, const struct scene_source *source,
                                     const struct scene *scene, const struct run_request *request,
                                     struct scene *calibrated);

/* Adds its files, if the scene's calibration is the folder's. Errors: STORAGE, MEMORY. */
sonject_status calibration_files_list(struct report *report, const struct scene *scene,
                                      const char *folder, json_t **files);

/* Logs which keys a scene has from its calibration. */
void tell_calibration(struct report *report, const struct scene *scene);

/* Logs what speaks against it: another side's, or one whose first returns are not what the scene's
 * recorded altitude says. */
void tell_calibration_doubts(struct report *report, const struct scene *scene);

/* Logs what a scene's user should know before it is run. */
void tell_scene(struct report *report, const struct scene *scene);

/* The word of a sonject_source. */
const char *source_word(uint32_t source);

/* The numbers that a run used and where they came from; NULL where memory is out. */
json_t *sources_document(const struct scene *scene, const sonject_statistics *statistics);

/* ---- What a folder holds of an earlier call: a result whose last document names what it was made
 * of and its files. */

#define RUN_DOCUMENT "run.json"

struct earlier_request {
    const char *folder, *document; /* the name of its last one, such as RUN_DOCUMENT */
    const json_t *inputs;          /* of the call's result */
    const struct scene *scene;     /* whose input may be a file */
    uint32_t label_formats;        /* that are wanted */
    bool overwrites;               /* another result may be given up */
    bool hashes_all;               /* see file_entry_holds */
};

/* Whether the folder holds the call's result, every file of it as it was written. One with a file
 * that is not so, or without wanted labels, is to be made again. Errors: ARGUMENT (another result;
 * the message names what differs), STORAGE, MEMORY. */
sonject_status earlier_check(struct report *report, const struct earlier_request *request,
                             bool *is_finished);

/* Whether inputs are the same: two objects whose members name each. image: the name of one that
 * differs besides, or NULL. Errors: ARGUMENT (they differ, and overwrites is false: the message
 * names the first), MEMORY. */
sonject_status inputs_check(struct report *report, const char *folder, const json_t *there,
                            const json_t *here, const char *image, bool overwrites, bool *is_same);

/* The same as earlier_check of a folder whose inputs are not known. Errors: INPUT (there is no
 * result, a file of it is not as it was written, or labels are missing), STORAGE, MEMORY. */
sonject_status earlier_check_merged(struct report *report, const char *folder,
                                    uint32_t label_formats);

/* Removes a result's document, so that the folder is not taken for complete while another is
 * written over it, and returns the list of its files, for earlier_tidy. Never fails. */
json_t *earlier_withdraw(const char *folder, const char *document);

/* Removes the files of an earlier result that are not among the new ones, and what dead processes
 * left; releases the earlier list. Never fails. */
void earlier_tidy(const char *folder, json_t *earlier, const json_t *files);

/* Adds to a document what earlier_check reads: inputs and list of files are copied by reference.
 * Errors: STORAGE, MEMORY. */
sonject_status earlier_describe(struct report *report, json_t **document, json_t *inputs,
                                json_t *files, const struct scene *scene);

/* Whether a run's results are in the folder. */
bool folder_has_result(const char *folder);

/* A document of the folder, for json_decref; NULL where there is none or it is damaged. Errors:
 * STORAGE, MEMORY. */
sonject_status earlier_document(struct report *report, const char *folder, const char *name,
                                json_t **document);

#endif
