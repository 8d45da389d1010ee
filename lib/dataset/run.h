/* Whole runs on files: from rays, from kept sums, or from shards. Also their files: images, labels
 * and JSON documents. Sums are what tracing leaves for image formation (trace/sums_file.h). */
#ifndef SONJECT_DATASET_RUN_H
#define SONJECT_DATASET_RUN_H

#include <jansson.h>

#include <sonject/run.h>
#include <sonject/stages.h>

#include "device/device.h"
#include "inject/checkpoints.h"
#include "inject/swath.h"

/* The share of a highlight's pixels at the image's ceiling above which a note tells the user. */
#define CLIPPED_MUCH 0.1

/* Visibility, dB, from which on a highlight stands out. */
#define STANDS_OUT_DB 0.1

/* The room between an echo's peak and the ceiling, so that speckle reaches the ceiling in only a
 * few of the echo's pixels. */
#define CEILING_ROOM_DB 3.0

#define LABEL_FORMATS ((uint32_t)(SONJECT_LABELS_YOLO | SONJECT_LABELS_VOC))

/* Injects and writes the folder's files; see sonject_run. was_finished may be NULL. */
sonject_status run_scene(struct report *report, struct device_slot *slot,
                         const struct run_request *request, int *was_finished);

/* Logs facts about a result that its numbers do not tell: empty rows, noise floor, accuracy, limits
 * of models, altitudes, objects that are not seen, pixels cut at full scale. */
void tell_result(struct report *report, const struct scene *scene, const struct swath *swath,
                 const struct injection_result *result);

/* Traces the request's scene and writes the sums to the file; see sonject_trace. */
sonject_status trace_scene(struct report *report, struct device_slot *slot,
                           const struct run_request *request, const char *file);

/* Forms the image of kept sums; see sonject_form. scene: NULL for the scene whose text is kept with
 * the sums. request: has the folder and the options. */
sonject_status form_scene(struct report *report, struct device_slot *slot,
                          const struct scene *scene, const sonject_form_params *params,
                          const struct run_request *request, int *was_finished);

/* Makes the result of all shards in the request's folder; see sonject_merge. The shards keep the
 * scene. If the folder has bands, each band gets a result in a folder of its own. */
sonject_status merge_folder(struct report *report, struct device_slot *slot,
                            const struct run_request *request, int *was_finished);

/* Reads the scene whose text a file keeps, with the overrides of params. params->file is for
 * messages. File names are relative to the folder where the scene was traced. calibration: file
 * used for input.calibration: auto; NULL: none. scene: the caller's for scene_clear, also on
 * failure. Errors: INPUT, STORAGE, MEMORY. */
sonject_status read_traced_scene(struct report *report, const struct kept_scene *kept,
                                 const sonject_form_params *params, const char *calibration,
                                 struct scene *scene);

/* Writes the hydrophones' time series of the input into the folder; see sonject_elements_run. */
sonject_status run_elements(struct report *report, struct device_slot *slot,
                            const struct scene *scene, const sonject_run_params *params,
                            sonject_progress_function progress, void *user);

/* Describes the scene's geometry as a text with a plan, for free(); see sonject_check. */
sonject_status describe_scene(struct report *report, const struct scene *scene, char **text);

struct run_facts {
    const struct scene *scene;
    const struct swath *swath;
    const struct injection_result *result;
    const struct device *device;
    const char *scene_hash; /* hash of scene and input; see inject/scene_hash.h */
    json_t *inputs;         /* inputs that are hashed, by name */
    json_t *files;          /* files written so far, as file_list_add lists them */
    json_t *page;           /* data of report.html besides truth; see write_layers, note_result */
    const char *image_name;
    const struct region *chip;         /* the image's place in `whole`; NULL: the swath's patch */
    const struct raster_layout *whole; /* layout of the swath that a chip was cut out of */
    uint32_t label_formats;            /* sum of sonject_labels */
    double read_s, write_s, total_s;
    int jpeg_quality; /* JPEG quality of the image; 0: without loss */
};

#define TRUTH_DOCUMENT "truth.json"
#define REPORT_PAGE    "report.html"
#define TRUTH_DIGITS   12

/* Returns the content of truth.json; NULL where memory is out. */
json_t *truth_document(const struct run_facts *facts);

/* Each writes one file, whole or not at all. Errors: STORAGE, MEMORY. */
sonject_status write_truth(struct report *report, const struct run_facts *facts, const char *path);
sonject_status write_run(struct report *report, const struct run_facts *facts, const char *path);

/* Writes report.html, whole or not at all. Takes over facts->page and links to facts->files.
 * Errors: STORAGE, MEMORY. */
sonject_status write_run_page(struct report *report, struct run_facts *facts, const char *path);

/* The text of lib/dataset/report_page.html, in which @DATA@ stands for the data. */
extern const char report_page[];

/* Writes a page that shows the data. data: released. digits: of the page's numbers. Errors:
 * STORAGE, MEMORY (also where data is NULL). */
sonject_status report_page_write(struct report *report, json_t *data, size_t digits,
                                 const char *path);

/* Counts the values in each of HISTOGRAM_BINS equal parts of low...high. Values beyond the ends
 * count in the outermost parts. */
#define HISTOGRAM_BINS 24
json_t *histogram_counts(const double *values, size_t count, double low, double high);

/* Parts of a result in files of their own. Masks have the swath's size, all others the patch's. */
enum layer {
    LAYER_FIELD,
    LAYER_ENERGY,
    LAYER_HIGHLIGHT,
    LAYER_SHADOW,
    LAYER_LABELS, /* the numbers of objects */
    LAYER_INFLUENCE
};
#define LAYERS (LAYER_INFLUENCE + 1)

/* Writes a layer's file. Errors: STORAGE, MEMORY. */
sonject_status write_layer(struct report *report, const struct run_facts *facts, enum layer layer,
                           const char *path);

/* Writes patch.tif, energy.tif, highlight.png, shadow.png, labels.png, influence.png, quicklook.png
 * and, where the result has them, energy_order_1.tif and so on into the folder. Each file is
 * written whole or not at all. Lists the files in facts->files, and adds the quicklook's panels and
 * the orders' energies to facts->page. Errors: STORAGE, MEMORY. */
sonject_status write_layers(struct report *report, struct run_facts *facts, const char *folder);

/* Writes coco.json, contacts.csv, and the files of facts->label_formats, and lists them in
 * facts->files. Removes label files of other formats of an earlier run. Errors: STORAGE, MEMORY. */
sonject_status write_labels(struct report *report, struct run_facts *facts, const char *folder);

/* Lists the files that a run writes or removes, but for its image. names: gets RUN_FILES and NULL.
 */
#define RUN_FILES 24
void run_file_names(const char *names[RUN_FILES + 1]);

/* Returns the formats (sum of sonject_labels) that a run.json names. */
uint32_t labels_of_document(const json_t *run);

/* Describes the device; NULL where memory is out. */
json_t *device_document(const struct device *device);

/* ---- Calibrations that scenes ask for by input.calibration: auto. */

#define CALIBRATION_NAME "calibration"

/* Calibrates the scene's image into folder/name.yaml, with a picture beside it, unless the file is
 * there. If replaces is true, a file is made again that was changed, or was made for another image,
 * channel, array or geometry or by another version. path: gets the file's name. Processes that make
 * the file at the same time make equal files. Errors: those of sonject_calibrate. */
sonject_status scene_calibrate(struct report *report, const struct scene *scene, const char *folder,
                               const char *name, bool replaces, char path[PATH_CAPACITY]);

/* Makes the calibration in the request's folder and reads the scene with it. calibrated: for
 * scene_clear, also on failure. Errors: those of scene_calibrate and scene_source_read. */
sonject_status calibrated_scene_read(struct report *report, const struct scene_source *source,
                                     const struct scene *scene, const struct run_request *request,
                                     struct scene *calibrated);

/* Adds the calibration's files to the list, if the scene's calibration is the folder's. Errors:
 * STORAGE, MEMORY. */
sonject_status calibration_files_list(struct report *report, const struct scene *scene,
                                      const char *folder, json_t **files);

/* Logs which keys a scene has from its calibration. */
void tell_calibration(struct report *report, const struct scene *scene);

/* Logs doubts about the scene's calibration: made for another side or swath, or first returns that
 * disagree with the scene's recorded altitude. hash: of the scene's swath. */
void tell_calibration_doubts(struct report *report, const struct scene *scene, const char *hash);

/* Logs what a scene's user should know before it is run. */
void tell_scene(struct report *report, const struct scene *scene, const struct swath *swath);

/* Returns the word of a sonject_source. */
const char *source_word(uint32_t source);

/* Returns the numbers that a run used and their sources; NULL where memory is out. */
json_t *sources_document(const struct scene *scene, const sonject_statistics *statistics);

/* ---- Results of earlier calls. A result's last document names its inputs and its files. */

#define RUN_DOCUMENT "run.json"

struct earlier_request {
    const char *folder, *document; /* the result's last document, such as RUN_DOCUMENT */
    const char *const *names;      /* files that the call writes or removes; NULL ends the list */
    const json_t *inputs;          /* inputs of the call's result */
    const struct scene *scene;     /* scene of the call, whose input may be a file */
    uint32_t label_formats;        /* wanted formats */
    bool overwrites;               /* another result may be replaced */
    bool hashes_all;               /* see file_entry_holds */
};

/* Finds whether the folder holds the call's result, with every file as it was written. A result
 * with a changed file, or without wanted labels, is to be made again. Files of these names that no
 * result explains are refused. Errors: ARGUMENT (another result; the message names the differences;
 * another's file), STORAGE, MEMORY. */
sonject_status earlier_check(struct report *report, const struct earlier_request *request,
                             bool *is_finished);

/* Compares the inputs of two results, objects with a member for each input. image: the name of an
 * image that differs besides, or NULL. Errors: ARGUMENT (inputs differ, and overwrites is false:
 * the message names the first ones), MEMORY. */
sonject_status inputs_check(struct report *report, const char *folder, const json_t *there,
                            const json_t *here, const char *image, bool overwrites, bool *is_same);

/* Checks a folder's result whose inputs are not known, as earlier_check does. Errors: INPUT (there
 * is no result, a file of it is not as it was written, or labels are missing), STORAGE, MEMORY. */
sonject_status earlier_check_merged(struct report *report, const char *folder,
                                    uint32_t label_formats);

/* Removes a result's document, so that the folder does not count as complete while another result
 * is written over it, and makes the folder `work`, which tells its files from others'. Returns the
 * list of the result's files, for earlier_tidy. Never fails. */
json_t *earlier_withdraw(const char *folder, const char *document);

/* Removes the files of an earlier result that are not among the new ones, the remains of dead
 * processes and, where the document was written, an empty folder `work`. Releases the earlier list.
 * Never fails. */
void earlier_tidy(const char *folder, const char *document, json_t *earlier, const json_t *files);

/* Adds the members that earlier_check reads to a document. Inputs and list of files are shared by
 * reference. Errors: STORAGE, MEMORY. */
sonject_status earlier_describe(struct report *report, json_t **document, json_t *inputs,
                                json_t *files, const struct scene *scene);

/* Returns whether the folder holds a run's result. */
bool folder_has_result(const char *folder);

/* Reads a document of the folder. document: for json_decref; NULL where there is no document or it
 * is damaged. Errors: STORAGE, MEMORY. */
sonject_status earlier_document(struct report *report, const char *folder, const char *name,
                                json_t **document);

#endif
