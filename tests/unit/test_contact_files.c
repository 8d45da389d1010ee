/* Tests labels of contacts: each format, as others and sonject itself write it, highlights and
 * shadows of one contact, and wrong labels. Images have 30 rows and 40 columns. */
#include "base/report.h"
#include "base/system/file_system.h"
#include "claims.h"
#include "clean_folder.h"
#include "dataset/contact_files.h"
#include "dataset/labels.h"
#include "swath/raster_file.h"

#define ROWS_OF_IMAGE    30
#define COLUMNS_OF_IMAGE 40

/* Writes a text into the test's own folder, which holds all labels and images. */
static void put(const char *name, const char *text)
{
    write_bytes(file_in(name), text, strlen(text));
}

static void put_image(const char *name)
{
    static const float pixels[ROWS_OF_IMAGE * COLUMNS_OF_IMAGE];
    const struct raster_layout layout = {ROWS_OF_IMAGE, COLUMNS_OF_IMAGE, 1, PIXEL_FLOAT32};
    EXPECT_OK(&report, raster_format_write(&report, file_in(name), &layout, NULL, 0, pixels));
}

/* Reads labels. name: of a file; "": the folder. */
static sonject_status read_set(const char *name, uint32_t part, struct contact_set *set)
{
    const struct contact_choice choice = {.part = part};
    report.message[0] = '\0';
    return contact_set_read(&report, *name ? file_in(name) : folder->path, &choice, set);
}

struct expected {
    const char *image; /* end of the image's path */
    uint32_t part;
    sonject_box box;
};

static void expect_contacts(const char *name, uint32_t part, const struct expected *expected,
                            size_t count)
{
    struct contact_set set;
    EXPECT_OK(&report, read_set(name, part, &set));
    assert_string_equal(report.message, "");
    contact_set_pair(&report, &set);
    assert_int_equal(set.count, count);
    assert_int_equal(set.quantiles.count, 0);
    for (size_t i = 0; i < count; i++) {
        const struct labelled_contact *contact = &set.contacts[i];
        assert_true(contact->image < set.image_count);
        const char *path = set.images[contact->image];
        assert_true(strlen(path) > strlen(expected[i].image));
        assert_string_equal(path + strlen(path) - strlen(expected[i].image), expected[i].image);
        assert_int_equal(contact->part, expected[i].part);
        const sonject_box *box = &expected[i].box;
        assert_int_equal(contact->box.first_row, box->first_row);
        assert_int_equal(contact->box.first_column, box->first_column);
        assert_int_equal(contact->box.rows, box->rows);
        assert_int_equal(contact->box.columns, box->columns);
    }
    contact_set_clear(&set);
    assert_null(set.contacts);
}

/* Expects a refusal. message: all of it, with % for the folder. */
static void expect_refused(const char *name, const char *message)
{
    struct contact_set set;
    char expected[REPORT_CAPACITY] = "";
    for (const char *c = message; *c; c++)
        sprintf(expected + strlen(expected), *c == '%' ? "%s" : "%.1s",
                *c == '%' ? folder->path : c);
    if (read_set(name, LABELLED_BOTH, &set) != SONJECT_ERROR_INPUT)
        fail_msg("not refused, though %s", message);
    contact_set_clear(&set);
    if (strcmp(report.message, expected) != 0)
        fail_msg("the message is\n%s\nand not\n%s", report.message, expected);
}

/* Makes a folder within a fresh one, since images are looked for beside the folder, too. */
static int make_labels_folder(void **state)
{
    if (begin(state) != 0)
        return 1;
    strcat(folder->path, "/labels");
    return folder_make_one(folder->path);
}

static int remove_labels_folder(void **state)
{
    *strrchr(folder->path, '/') = '\0';
    return remove_temporary_folder(state);
}

#define WITH_LABELS(name) TEST_WITH(name, make_labels_folder, remove_labels_folder)

struct wrong {
    const char *text, *message;
};

/* Writes each wrong text to a file. read: the file, or "" for the folder. */
static void expect_all_refused(const char *file, const char *read, const struct wrong *wrong,
                               size_t count)
{
    for (size_t i = 0; i < count; i++) {
        put(file, wrong[i].text);
        expect_refused(read, wrong[i].message);
    }
}

/* ---- COCO. */

#define IMAGES                                                                                     \
    "{\"images\": [{\"id\": 7, \"file_name\": \"b.npy\", \"width\": 40, \"height\": 30},\n"        \
    "{\"id\": \"x\", \"file_name\": \"a.npy\"}, {\"id\": 3, \"file_name\": \"none.npy\"}],\n"
#define CATEGORIES                                                                                 \
    "\"categories\": [{\"id\": 1, \"name\": \"mine\"}, {\"id\": 2, \"name\": \"Acoustic SHADOW\"}" \
    ", {\"id\": 4, \"name\": \"mine-echo\"}, {\"id\": 5, \"name\": \"highlight, shadow\"}],\n"
#define ANNOTATIONS(text) IMAGES CATEGORIES "\"annotations\": [" text "]}"
#define ANNOTATION(image, category, box)                                                           \
    "{\"image_id\": " image ", \"category_id\": " category ", \"bbox\": " box "}"

#define FOUR(a, b, c, d) a ",\n" b ",\n" c ",\n" d

WITH_LABELS(test_coco)
{
    const struct expected expected[] = {{"/b.npy", LABELLED_SHADOW, {20, 0, 2, 40}},
                                        {"/b.npy", LABELLED_BOTH, {25, 1, 5, 3}},
                                        {"/a.npy", LABELLED_HIGHLIGHT, {2, 3, 4, 5}},
                                        {"/a.npy", LABELLED_HIGHLIGHT, {6, 100, 1, 1}}};
    put_image("a.npy");
    put_image("b.npy");
    put("labels.json", ANNOTATIONS(FOUR(ANNOTATION("7", "5", "[1, 25, 3, 5]"),
                                        ANNOTATION("\"x\"", "1", "[100.2, 6.4, 0.1, 0.1]"),
                                        ANNOTATION("7", "2", "[-0.6, 20, 41.5, 2]"),
                                        ANNOTATION("\"x\"", "4", "[2.6, 2.4, 5.3, 3.7]"))));
    expect_contacts("labels.json", LABELLED_HIGHLIGHT, expected, COUNT(expected));
}

WITH_LABELS(test_coco_that_is_wrong)
{
    static const struct wrong wrong[] = {
        {"{\"images\": [],\n}", "%/l.json: damaged in line 2: string or '}' expected near '}'; "
                                "mend it, or remove it and run that again"},
        {"[]", "%/l.json: damaged: no JSON object; remove it and run that again"},
        {"{}", "%/l.json: images: must be a list, as COCO has it"},
        {"{\"images\": [3]}", "%/l.json: images[0]: needs an id and a file_name"},
        {"{\"images\": [{\"id\": 1}]}", "%/l.json: images[0]: needs an id and a file_name"},
        {"{\"images\": [{\"id\": 1, \"file_name\": \"a\"}, {\"id\": 1, \"file_name\": \"b\"}]}",
         "%/l.json: images[1].id: an entry before has it, too"},
        {IMAGES "\"categories\": [{\"id\": 1}]}",
         "%/l.json: categories[0]: needs an id and a name"},
        {IMAGES CATEGORIES "\"annotations\": {}}",
         "%/l.json: annotations: must be a list, as COCO has it"},
        {ANNOTATIONS(""), "%/l.json: holds no contacts"},
        {ANNOTATIONS("1"),
         "%/l.json: annotations[0]: bbox must be four numbers of pixels, [x, y, width, height]"},
        {ANNOTATIONS(ANNOTATION("7", "1", "[1, 2, 3]")),
         "%/l.json: annotations[0]: bbox must be four numbers of pixels, [x, y, width, height]"},
        {ANNOTATIONS(ANNOTATION("7", "1", "[1, 2, 3, \"4\"]")),
         "%/l.json: annotations[0]: bbox must be four numbers of pixels, [x, y, width, height]"},
        {ANNOTATIONS(ANNOTATION("8", "1", "[1, 2, 3, 4]")),
         "%/l.json: annotations[0]: image_id is of none of the images"},
        {ANNOTATIONS(ANNOTATION("7", "3", "[1, 2, 3, 4]")),
         "%/l.json: annotations[0]: category_id is of none of the categories"},
        {ANNOTATIONS(ANNOTATION("7", "1", "[1, 2, 3, 4]") "," ANNOTATION("3", "1", "[1, 2, 3, 4]")),
         "%/l.json: annotations[1]: there is no image 'none.npy', neither beside the labels nor in "
         "'images' below or beside them"},
        {ANNOTATIONS(ANNOTATION("7", "1", "[1, 2, 3, 0]")),
         "%/l.json: annotations[0]: the box has no area: 0 rows and 3 columns; mend or remove it"},
        {ANNOTATIONS(ANNOTATION("7", "1", "[1, 2, -3, 4]")),
         "%/l.json: annotations[0]: the box has no area: 4 rows and -3 columns; mend or remove it"},
        {ANNOTATIONS(ANNOTATION("7", "1", "[38, 2, 3.5, 4]")),
         "%/l.json: annotations[0]: the box, rows 2 to 6 and columns 38 to 41.5, is not in the "
         "image of 30 rows and 40 columns"},
        {ANNOTATIONS(ANNOTATION("\"x\"", "1", "[38, -2, 3.5, 4]")),
         "%/l.json: annotations[0]: the box, rows -2 to 2 and columns 38 to 41.5, is not in the "
         "image"},
        {ANNOTATIONS(ANNOTATION("\"x\"", "1", "[0, 1, 1e300, 4]")),
         "%/l.json: annotations[0]: the box, rows 1 to 5 and columns 0 to 1e+300, is not in the "
         "image"},
        {"{\"images\": [{\"id\": 7, \"file_name\": \"a\\u0007.png\"}],\n" CATEGORIES
         "\"annotations\": [" ANNOTATION("7", "1", "[1, 2, 3, 4]") "]}",
         "%/l.json: annotations[0]: the image's name must be a text"},
        {"{\"images\": [{\"id\": 7, \"file_name\": \"b.npy\", \"width\": 0}],\n" CATEGORIES
         "\"annotations\": [" ANNOTATION("7", "1", "[1, 2, 3, 4]") "]}",
         "%/l.json: annotations[0]: its image's width or height is not a whole number of pixels"},
    };
    put_image("a.npy");
    put_image("b.npy");
    expect_all_refused("l.json", "l.json", wrong, COUNT(wrong));
    expect_refused("none.json", "%/none.json: there is no such file or folder of labels");
    expect_refused("b.npy",
                   "%/b.npy: no labels: neither .json (COCO), .csv, .yaml (quantiles) nor a folder "
                   "of .txt (YOLO) or .xml (VOC)");
}

/* ---- CSV. */

/* A mark in a file's name, and the same within quotation marks. */
#ifdef HAS_POSIX
#define MARK        "\""
#define QUOTED_MARK "\"\""
#else
#define MARK        "'"
#define QUOTED_MARK "'"
#endif

WITH_LABELS(test_tables)
{
    const struct expected expected[] = {
        {"/a.npy", LABELLED_SHADOW, {1, 2, 3, 4}},
        {"/a.npy", LABELLED_BOTH, {6, 2, 3, 4}},
        {"/a.npy", LABELLED_HIGHLIGHT, {9, 2, 3, 4}},
        {"/b " MARK "2" MARK ", 3.npy", LABELLED_HIGHLIGHT, {0, 0, 1, 500}}};
    put_image("a.npy");
    put_image("b " MARK "2" MARK ", 3.npy");
    put("labels.csv", "image,row,column,rows,columns,part # comment\n\n"
                      "a.npy,9,2,3,4,\na.npy,0.6,2.3,3,4,Shadow\n\"a.npy\",6,2,3,4,both\n"
                      "\"b " QUOTED_MARK "2" QUOTED_MARK ", 3.npy\",0,0,1,500,\"highlight\"\n");
    expect_contacts("labels.csv", LABELLED_HIGHLIGHT, expected, COUNT(expected));
    put("labels.CSV",
        "class;rows;columns;row;column;image\nshadow;3;4;1;2;a.npy\nechoes and shadows;3;4;6;2;"
        "a.npy\nrock;3;4;9;2;a.npy\n;1;500;0;0;b " MARK "2" MARK ", 3.npy\n");
    expect_contacts("labels.CSV", LABELLED_HIGHLIGHT, expected, COUNT(expected));
}

WITH_LABELS(test_tables_that_are_wrong)
{
#define T "image,row,column,rows,columns,part\n"
    static const struct wrong wrong[] = {
        /* test_profile_table.c tests the mistakes of any table */
        {T, "%/l.csv: holds no contacts"},
        {"image,row,column,rows,part\n",
         "%/l.csv:1: columns: there is no such column; there must be image, row, column, rows, "
         "columns, or those of sonject's contacts.csv"},
        {"image,row,box_row,column,rows,part\n",
         "%/l.csv:1: box_column: there is no such column; there must be image, row, column, rows, "
         "columns, or those of sonject's contacts.csv"},
        {"image,row,column,rows,columns,row\n",
         "%/l.csv:1: row: two columns of this name; rename one"},
        {T "a.npy,1,2,3,,\n", "%/l.csv:2: columns: '' is not a number"},
        {T "a.npy,,,,,\n", "%/l.csv:2: row: '' is not a number"},
        {T "a.npy,1,2 m,3,4,\n", "%/l.csv:2: column: '2 m' is not a number"},
        {T "a.npy,1,2,3,4,tail\n", "%/l.csv:2: part: 'tail' is not one of highlight, shadow, both"},
        {T "# a\n,1,2,3,4,\n", "%/l.csv:3: no image is named"},
        {T "c.npy,1,2,3,4,\n", "%/l.csv:2: there is no image 'c.npy', neither beside the labels "
                               "nor in 'images' below or beside them"},
        {T "a.npy,1,2,3,0,\n",
         "%/l.csv:2: the box has no area: 3 rows and 0 columns; mend or remove it"},
        {T "a.npy,1,2,inf,4,\n",
         "%/l.csv:2: the box, rows 1 to inf and columns 2 to 6, is not in the image"},
    };
    put_image("a.npy");
    expect_all_refused("l.csv", "l.csv", wrong, COUNT(wrong));
}

WITH_LABELS(test_so_many_contacts_and_no_more)
{
    enum {
        MOST = 100000
    };
    struct contact_set set;
    put_image("a.npy");
    for (int more = 0; more < 2; more++) {
        FILE *file = open_new_file(file_in("l.csv"));
        assert_non_null(file);
        fprintf(file, "image,row,column,rows,columns\n");
        for (int i = 0; i < MOST + more; i++)
            fprintf(file, "a.npy,%d,0,1,1\n", i);
        fclose(file);
        if (more) {
            expect_refused("l.csv", "%/l.csv:100002: more than 100000 contacts; leave some out");
            continue;
        }
        EXPECT_OK(&report, read_set("l.csv", LABELLED_BOTH, &set));
        assert_int_equal(set.count, MOST);
        assert_int_equal(set.contacts[MOST - 1].box.first_row, MOST - 1);
        assert_int_equal(set.image_count, 1);
        contact_set_clear(&set);
    }
}

/* ---- YOLO. */

WITH_LABELS(test_yolo)
{
    /* fractions: x 8 to 16 of 40, y 3 to 9 of 30; then the whole image */
    static const char text[] = "1 0.3 0.2 0.2 0.2\r\n\n 0\t0.5 0.5 1 1 \n";
    struct expected expected[] = {{"/a.b.npy", LABELLED_HIGHLIGHT, {20, 10, 2, 4}},
                                  {"/a.npy", LABELLED_HIGHLIGHT, {0, 0, 30, 40}},
                                  {"/a.npy", LABELLED_HIGHLIGHT, {3, 8, 6, 8}}};
    put_image("a.npy");
    put_image("a.b.npy");
    put("a.txt", text);
    put("a.b.txt", "1 0.3 0.7 0.1 0.06666666667");
    put("empty.txt", "\n");
    put("a.jgw", "no image\n");
    expect_contacts("", LABELLED_HIGHLIGHT, expected, 3);
    put("classes.txt", "echo\r\nx\n");
    expect_contacts("", LABELLED_HIGHLIGHT, expected, 3);
    (void)unlink(file_in("classes.txt"));
    put("data.yaml", "train: images\nnc: 2\nnames: [rock, both_echo_and_shadow]\n");
    for (int i = 0; i < 3; i++)
        expected[i].part = LABELLED_BOTH;
    expect_contacts("", LABELLED_BOTH, expected, 3);
    put("data.yaml", "names:\n  1: shadows\n  0: rock\n");
    expected[0].part = expected[2].part = LABELLED_SHADOW;
    expect_contacts("", LABELLED_BOTH, expected, 3);
}

WITH_LABELS(test_yolo_that_is_wrong)
{
#define NO_LINE                                                                                    \
    " is not a class's number and four fractions: the box's centre x and y, its width and height"
    static const struct wrong wrong[] = {
        {"", "%: holds no contacts"},
        {"0 0.5 0.5 0.2 0.2\n0 0.5 0.5 0.2\n", "%/a.txt:2: '0 0.5 0.5 0.2'" NO_LINE},
        {"0 0.5 0.5 0.2 0.2 0.9\n", "%/a.txt:1: '0 0.5 0.5 0.2 0.2 0.9'" NO_LINE},
        {"0 0.5.5 0.5 0.2\n", "%/a.txt:1: '0 0.5.5 0.5 0.2'" NO_LINE},
        {"0.5 0.5 0.5 0.2 0.2\n", "%/a.txt:1: '0.5 0.5 0.5 0.2 0.2'" NO_LINE},
        {"mine 0.5 0.5 0.2 0.2\n", "%/a.txt:1: 'mine 0.5 0.5 0.2 0.2'" NO_LINE},
        {"\n2 0.5 0.5 0.2 0.2\n", "%/a.txt:2: class 2 has no name in %/classes.txt"},
        {"0 0.5 0.5 0.2 0\n",
         "%/a.txt:1: the box has no area: 0 rows and 8 columns; mend or remove it"},
        {"0 20 15 8 6\n", "%/a.txt:1: the box, rows 360 to 540 and columns 640 to 960, is not in "
                          "the image of 30 rows and 40 columns"},
    };
    put_image("a.npy");
    put("classes.txt", "mine\nshadow\n");
    expect_all_refused("a.txt", "", wrong, COUNT(wrong));
    write_bytes(file_in("a.txt"), "0 0.5 0.5\0 0.2 0.2\n", 19);
    expect_refused("", "%/a.txt: is no text");
    put("a.txt", "0 0.5 0.5 0.2 0.2\n");
    put("classes.txt", "mi\x01ne\n");
    expect_refused("", "%/classes.txt: class 0 is no text");
    (void)unlink(file_in("classes.txt"));
    put("data.yaml", "names: [[a]]\n");
    expect_refused("", "%/data.yaml:1:9: names: a class's name must be a text");
    put("data.yaml", "names: [a\n");
    expect_refused("",
                   "%/data.yaml:2:1: names: not valid YAML (while parsing a flow sequence: did not "
                   "find expected ',' or ']'); check indentation, colons, quotes and brackets");
    (void)unlink(file_in("data.yaml"));
    (void)unlink(file_in("a.npy"));
    struct contact_set set;
    put("a.npz", "no image");
    assert_int_equal(read_set("", LABELLED_BOTH, &set), SONJECT_ERROR_INPUT);
    assert_non_null(strstr(report.message, "/a.npz: is of no format that sonject knows"));
    contact_set_clear(&set);
    (void)unlink(file_in("a.npz"));
    expect_refused("",
                   "%/a.txt:1: there is no image of that name, neither beside the labels nor in "
                   "'images' below or beside them");
    (void)unlink(file_in("a.txt"));
    expect_refused("",
                   "%: no labels: neither .json (COCO), .csv, .yaml (quantiles) nor a folder of "
                   ".txt (YOLO) or .xml (VOC)");
}

/* Labels are in data/labels/train, with images in data/images/train, or elsewhere about them. */
WITH_LABELS(test_where_images_are_looked_for)
{
    static const char *const folders[] = {"labels",           "labels/train", "labels/train/images",
                                          "labels/images",    "images",       "images/train",
                                          "labels/JPEGImages"};
    static const char *const places[] = {"labels/train/a.npy", "labels/train/images/a.npy",
                                         "labels/a.npy",       "labels/images/a.npy",
                                         "images/train/a.npy", "labels/JPEGImages/a.npy"};
    static const char *const labels[] = {"labels/train/a.txt", "labels/train/l.csv"};
    struct expected expected = {NULL, LABELLED_BOTH, {3, 8, 6, 8}};
    for (size_t i = 0; i < COUNT(folders); i++)
        assert_int_equal(folder_make_one(file_in(folders[i])), 0);
    put(labels[0], "0 0.3 0.2 0.2 0.2\n");
    put(labels[1], "image,row,column,rows,columns\na.npy,3,8,6,8\n");
    for (size_t i = 0; i < COUNT(places); i++) {
        put_image(places[i]);
        expected.image = "/a.npy";
        expect_contacts(labels[1], LABELLED_BOTH, &expected, 1);
        expect_contacts("labels/train", LABELLED_BOTH, &expected, 1);
        (void)unlink(file_in(places[i]));
    }
}

/* ---- VOC. */

#define BOX(a, b, c, d)                                                                            \
    "<bndbox><xmin>" #a "</xmin><ymin>" #b "</ymin><xmax> " #c " </xmax><ymax>" #d                 \
    "</ymax></bndbox>"
#define OBJECT(name, box) "<object><name>" name "</name>" box "</object>"
#define SIZE              "<size><width>40</width><height>30</height><depth>1</depth></size>\n"

WITH_LABELS(test_voc)
{
    const struct expected expected[] = {{"/a&b.npy", LABELLED_SHADOW, {0, 0, 1, 1}},
                                        {"/a&b.npy", LABELLED_SHADOW, {2, 1, 8, 39}},
                                        {"/c.npy", LABELLED_BOTH, {9, 4, 2, 100}}};
    put_image("a&b.npy");
    put_image("c.npy");
#define DEEP "longer-than-there-is-room-for-on-the-way-to-an-element"
    put("1.xml",
        "<?xml version='1.0'?>\n<annotation><folder>x</folder>" OBJECT(
            "\n shadow\n", BOX(0, 1, 1, 1)) "<filename>a&amp;b.npy\n</filename>" SIZE
                                            "<object><part><name>highlight</name>" BOX(
                                                5, 5, 6,
                                                6) "</part>echo <name>rock's shadow</name>"
                                                   "<" DEEP "><name>highlight</name></" DEEP
                                                   ">" BOX(2, 3, 40, 10) "</object></annotation>");
    put("2.xml", "<annotation><filename>c.npy</filename>" OBJECT(
                     "r", BOX(5, 10, 104.2, 11)) "</annotation>");
    put("3.xml", "<annotation><filename>none</filename></annotation>");
    put("classes.txt", "rock\n");
    expect_contacts("", LABELLED_BOTH, expected, COUNT(expected));
}

WITH_LABELS(test_voc_that_is_wrong)
{
#define VOC(text) "<annotation>\n<filename>a.npy</filename>\n" SIZE text "</annotation>"
#define NEEDS     "%/a.xml:4: an object needs a name, and a bndbox of xmin, ymin, xmax, ymax"
    static const struct wrong wrong[] = {
        {"", "%/a.xml:1: no XML: no element found"},
        {"<annotation>\n<object></annotation>", "%/a.xml:2: no XML: mismatched tag"},
        {"<html></html>",
         "%/a.xml:1: an annotation of VOC begins with <annotation>, not with html"},
        {VOC(""), "%: holds no contacts"},
        {VOC(OBJECT("mine", BOX(1, 2, 3, 4)) OBJECT("mine", "")), NEEDS},
        {VOC("<object>" BOX(1, 2, 3, 4) "</object>"), NEEDS},
        {VOC(OBJECT("mine", BOX(1, 2, 3, 4)) "<object>" BOX(1, 2, 3, 4) "</object>"), NEEDS},
        {VOC(OBJECT("mine", "<bndbox><xmin>1</xmin><ymin>1</ymin><xmax>1</xmax></bndbox>")), NEEDS},
        {VOC(OBJECT("mine", BOX(1, 2, three, 4))), "%/a.xml:4: is no number of pixels: three"},
        {VOC("<size><width>-4</width></size>"), "%/a.xml:4: is no number of pixels: -4"},
        {VOC(OBJECT("mine", BOX(3, 2, 2, 4))),
         "%/a.xml:4: the box has no area: 3 rows and 0 columns; mend or remove it"},
        {VOC(OBJECT("mine", BOX(3, 2, 42, 4))),
         "%/a.xml:4: the box, rows 1 to 4 and columns 2 to 42, is not in the image of 30 rows and "
         "40 columns"},
        {"<annotation>" OBJECT("mine", BOX(1, 2, 3, 4)) "</annotation>",
         "%/a.xml:1: no image is named"},
        {"<annotation><filename>c</filename>" OBJECT("mine", BOX(1, 2, 3, 4)) "</annotation>",
         "%/a.xml:1: there is no image 'c', neither beside the labels nor in 'images' below or "
         "beside them"},
    };
    put_image("a.npy");
    expect_all_refused("a.xml", "", wrong, COUNT(wrong));
    static char text[10000] = "<annotation><filename>";
    memset(text + strlen(text), 'a', 9000);
    put("a.xml", strcat(text, "</filename></annotation>"));
    expect_refused("", "%/a.xml:1: more text than an annotation has in /annotation/filename");
}

/* ---- Labels that sonject itself writes. */

WITH_LABELS(test_own_labels_are_read_as_they_were_written)
{
    static const sonject_box boxes[] = {
        {0, 0, 30, 40}, {0, 39, 1, 1}, {7, 3, 11, 13}, {13, 17, 9, 7}, {29, 0, 1, 23}};
    static const char *const names[LABEL_FILES] = {"coco.json", "contacts.csv", "image.txt",
                                                   "classes.txt", "image.xml"};
    enum {
        CONTACTS = COUNT(boxes)
    };
    static sonject_object_params objects[CONTACTS + 1];
    static sonject_object_truth truth;
    struct contact contacts[CONTACTS + 1];
    struct class_names classes = {NULL, 0};
    struct image_labels labels = {"image.npy", ROWS_OF_IMAGE, COLUMNS_OF_IMAGE,
                                  false,       contacts,      CONTACTS + 1};
    struct expected expected[CONTACTS];
    memset(contacts, 0, sizeof contacts);
    put_image("image.npy");
    for (uint32_t i = 0; i < CONTACTS + 1; i++) {
        struct contact *contact = &contacts[i];
        snprintf(objects[i].name, sizeof objects[i].name, "=a, \"b\" # %u", i);
        snprintf(objects[i].class_name, sizeof objects[i].class_name, "%s",
                 i == 2  ? "rock & shadow"
                 : i % 2 ? "\"#1\" mine"
                         : "a, b");
        contact->number = i + 1;
        contact->object = &objects[i];
        contact->truth = &truth;
        EXPECT_OK(&report, class_names_take(&classes, &report, objects[i].class_name,
                                            &contact->class_number));
        if (i == CONTACTS)
            break; /* nothing of this contact is seen */
        contact->box = boxes[i];
        contact->pixels = 1;
        expected[i] =
            (struct expected){"/image.npy", i == 2 ? LABELLED_SHADOW : LABELLED_BOTH, boxes[i]};
    }
    for (int file = 0; file < LABEL_FILES; file++) {
        EXPECT_OK(&report, labels_write(&report, &labels, &classes, (enum label_file)file,
                                        file_in(names[file])));
        if (file != LABEL_YOLO)
            expect_contacts(file < LABEL_YOLO ? names[file] : "", LABELLED_BOTH, expected,
                            CONTACTS);
    }
    class_names_clear(&classes);
}

/* ---- Notes. */

/* The line that was noted last. */
static char noted[400];

static void keep_note(void *user, uint32_t level, const char *line)
{
    (void)user;
    (void)level;
    snprintf(noted, sizeof noted, "%s", line);
}

/* ---- Highlights and shadows. */

#define MIRROR 1000

/* Expects the same contacts, in any order, where range grows to the left. */
static void expect_mirrored(const char *name, const struct expected *expected, size_t count)
{
    struct contact_set set;
    EXPECT_OK(&report, read_set(name, LABELLED_BOTH, &set));
    for (size_t i = 0; i < set.count; i++) {
        sonject_box *box = &set.contacts[i].box;
        box->first_column = MIRROR - box->first_column - box->columns;
        set.contacts[i].is_reversed = true;
    }
    contact_set_pair(&report, &set);
    assert_int_equal(set.count, count);
    for (size_t i = 0; i < count; i++) {
        size_t found = 0;
        for (size_t k = 0; k < count; k++) {
            const struct labelled_contact *contact = &set.contacts[k];
            sonject_box box = contact->box;
            box.first_column = MIRROR - box.first_column - box.columns;
            found += contact->part == expected[i].part &&
                     memcmp(&box, &expected[i].box, sizeof box) == 0;
        }
        assert_int_equal(found, 1);
    }
    contact_set_clear(&set);
}

/* Labels of one box and part are one contact, whatever their classes; other parts are others. */
WITH_LABELS(test_a_label_that_is_given_again_counts_once)
{
    struct contact_set set;
    const struct report_host no_user = {0};
    put_image("a.npy");
    put_image("b.npy");
    put("l.csv", "image,class,row,column,rows,columns\na.npy,mine,5,10,4,3\na.npy,rock,5,10,4,3\n"
                 "b.npy,mine,5,10,4,3\na.npy,mine,5,10,4,3\na.npy,a shadow,5,10,4,3\n");
    EXPECT_OK(&report, read_set("l.csv", LABELLED_BOTH, &set));
    assert_int_equal(set.count, 5);
    report.log = keep_note;
    report.host = &no_user;
    contact_set_pair(&report, &set);
    report.log = NULL;
    report.host = NULL;
    assert_int_equal(set.count, 3);
    assert_string_equal(noted, "2 of 5 labels repeat another one, box and part, and are left out");
    contact_set_clear(&set);
}

/* Parts of two sides of an image are no contact, though they lie side by side. */
WITH_LABELS(test_parts_of_two_sides_are_two_contacts)
{
    struct contact_set set;
    put_image("a.npy");
    put("l.csv", "image,part,row,column,rows,columns\na.npy,highlight,5,10,4,3\n"
                 "a.npy,shadow,5,13,4,9\n");
    EXPECT_OK(&report, read_set("l.csv", LABELLED_BOTH, &set));
    set.contacts[0].seen_side = 1;
    set.contacts[1].seen_side = 2;
    contact_set_pair(&report, &set);
    assert_int_equal(set.count, 2);
    contact_set_clear(&set);
}

WITH_LABELS(test_highlight_and_shadow_are_one_contact)
{
#define H "a.npy,highlight,"
#define S "a.npy,shadow,"
    static const struct {
        const char *rows; /* image, part, row, column, rows, columns */
        size_t count;
        struct expected expected[4];
    } cases[] = {
        {H "5,10,4,3\n" S "4,13,6,9\n", 1, {{"", LABELLED_BOTH, {4, 10, 6, 12}}}},
        {S "4,13,3,9\n" H "5,10,14,3\n", 1, {{"", LABELLED_BOTH, {4, 10, 15, 12}}}},
        /* highlights that begin in a shadow; one that begins where the shadow ends */
        {S "4,13,3,9\n" H "5,14,1,10\n", 1, {{"", LABELLED_BOTH, {4, 13, 3, 11}}}},
        {S "4,13,3,9\n" H "5,21,1,1\n", 1, {{"", LABELLED_BOTH, {4, 13, 3, 9}}}},
        {S "4,13,3,9\n" H "5,22,1,1\n",
         2,
         {{"", LABELLED_SHADOW, {4, 13, 3, 9}}, {"", LABELLED_HIGHLIGHT, {5, 22, 1, 1}}}},
        /* other rows, another image, boxes around both */
        {S "4,13,3,9\n" H "7,10,2,3\n" H "1,10,3,3\n",
         3,
         {{"", LABELLED_HIGHLIGHT, {1, 10, 3, 3}},
          {"", LABELLED_SHADOW, {4, 13, 3, 9}},
          {"", LABELLED_HIGHLIGHT, {7, 10, 2, 3}}}},
        {S "4,13,3,9\nb.npy,highlight,4,10,3,3\na.npy,both,4,10,3,3\n",
         3,
         {{"", LABELLED_BOTH, {4, 10, 3, 3}},
          {"", LABELLED_SHADOW, {4, 13, 3, 9}},
          {"/b.npy", LABELLED_HIGHLIGHT, {4, 10, 3, 3}}}},
        /* one contact behind the other; one beside the other, with overlapping rows */
        {S "4,34,4,6\n" H "4,10,4,4\n" S "4,14,4,10\n" H "4,30,4,4\n",
         2,
         {{"", LABELLED_BOTH, {4, 10, 4, 14}}, {"", LABELLED_BOTH, {4, 30, 4, 10}}}},
        {S "4,14,6,6\n" S "8,14,6,6\n" H "9,10,5,4\n" H "4,10,5,4\n",
         2,
         {{"", LABELLED_BOTH, {4, 10, 6, 10}}, {"", LABELLED_BOTH, {8, 10, 6, 10}}}},
        /* the middles of rows decide; parts in other rows do not matter */
        {S "4,14,4,6\n" S "5,14,4,6\n" H "6,10,2,4\n",
         2,
         {{"", LABELLED_SHADOW, {4, 14, 4, 6}}, {"", LABELLED_BOTH, {5, 10, 4, 10}}}},
        {S "4,13,3,9\n" H "2,10,2,3\n" H "4,0,3,3\n",
         2,
         {{"", LABELLED_HIGHLIGHT, {2, 10, 2, 3}}, {"", LABELLED_BOTH, {4, 0, 3, 22}}}},
        {H "4,10,3,3\n" S "2,13,2,9\n" S "4,20,3,9\n",
         2,
         {{"", LABELLED_SHADOW, {2, 13, 2, 9}}, {"", LABELLED_BOTH, {4, 10, 3, 19}}}},
        /* one contact's rows begin with the highlight, another's with the shadow */
        {H "4,10,9,3\n" S "12,13,3,9\n" S "3,33,9,3\n" H "11,30,3,3\n",
         2,
         {{"", LABELLED_BOTH, {3, 30, 11, 6}}, {"", LABELLED_BOTH, {4, 10, 11, 12}}}},
        /* a shadow is nearest to a highlight that has a nearer one, and keeps the one left over */
        {S "4,20,4,12\n" H "4,30,4,4\n" S "4,34,4,6\n",
         2,
         {{"", LABELLED_SHADOW, {4, 20, 4, 12}}, {"", LABELLED_BOTH, {4, 30, 4, 10}}}},
        {S "4,20,4,12\n" H "4,30,4,4\n" S "4,34,4,6\n" H "4,0,4,4\n",
         2,
         {{"", LABELLED_BOTH, {4, 0, 4, 32}}, {"", LABELLED_BOTH, {4, 30, 4, 10}}}},
    };
    char text[400];
    put_image("a.npy");
    put_image("b.npy");
    for (size_t i = 0; i < COUNT(cases); i++) {
        snprintf(text, sizeof text, "image,class,row,column,rows,columns\n%s", cases[i].rows);
        put("l.csv", text);
        expect_contacts("l.csv", LABELLED_BOTH, cases[i].expected, cases[i].count);
        expect_mirrored("l.csv", cases[i].expected, cases[i].count);
    }
    put("l.csv", "image,class,row,column,rows,columns\na.npy,mine,5,10,4,3\n" S "4,13,6,9\n");
    expect_contacts("l.csv", LABELLED_HIGHLIGHT, cases[0].expected, 1);
}

/* ---- Chosen classes. */

/* Each format gives the mine's label alone, though the boulder's image is not there. */
WITH_LABELS(test_labels_of_chosen_classes_are_read)
{
    static const char *const names[] = {"nothing", "mine"};
    static const struct contact_choice choice = {
        .part = LABELLED_BOTH, .classes = names, .class_count = 2};
    static const char *const read[] = {"l.json", "l.csv", "", ""};
    put_image("a.npy");
    put("l.json", "{\"images\": [{\"id\": 1, \"file_name\": \"a.npy\"}, "
                  "{\"id\": 2, \"file_name\": \"none.npy\"}],\n"
                  "\"categories\": [{\"id\": 1, \"name\": \"mine\"}, "
                  "{\"id\": 2, \"name\": \"boulder\"}],\n\"annotations\": [" ANNOTATION(
                      "2", "2", "[1, 2, 3, 4]") "," ANNOTATION("1", "1", "[8, 3, 8, 6]") "]}");
    put("l.csv", "image,row,column,rows,columns,class\nnone.npy,0,0,1,1,boulder\n"
                 "a.npy,3,8,6,8,mine\n");
    for (size_t i = 0; i < COUNT(read); i++) {
        struct contact_set set;
        if (i == 2) {
            put("classes.txt", "boulder\nmine\n");
            put("a.txt", "0 0.5 0.5 1 1\n1 0.3 0.2 0.2 0.2\n");
        } else if (i == 3) {
            put("a.xml", "<annotation><filename>a.npy</filename>"
                         "<object><name>boulder</name><bndbox><xmin>1</xmin><ymin>1</ymin>"
                         "<xmax>2</xmax><ymax>2</ymax></bndbox></object>"
                         "<object><name>mine</name><bndbox><xmin>9</xmin><ymin>4</ymin>"
                         "<xmax>16</xmax><ymax>9</ymax></bndbox></object></annotation>");
        }
        EXPECT_OK(&report, contact_set_read(&report, *read[i] ? file_in(read[i]) : folder->path,
                                            &choice, &set));
        assert_int_equal(set.count, 1);
        assert_int_equal(set.image_count, 1);
        const sonject_box *box = &set.contacts[0].box;
        const uint64_t sides[] = {box->first_row, box->first_column, box->rows, box->columns};
        assert_memory_equal(sides, ((const uint64_t[]){3, 8, 6, 8}), sizeof sides);
        contact_set_clear(&set);
    }
}

WITH_LABELS(test_classes_that_are_taken_as_one_are_told)
{
    static const char *const names[] = {"mime"};
    static const struct contact_choice choice = {.classes = names, .class_count = 1};
    struct contact_set set;
    put_image("a.npy");
    put("l.csv", "image,row,column,rows,columns,class\na.npy,3,8,6,8,mine\n"
                 "a.npy,0,0,1,1,boulder\na.npy,0,4,1,1,mine\na.npy,0,4,1,1,a shadow\n");
    const struct report_host no_user = {0};
    report.log = keep_note;
    report.host = &no_user;
    EXPECT_OK(&report, read_set("l.csv", LABELLED_BOTH, &set));
    report.log = NULL;
    report.host = NULL;
    contact_set_clear(&set);
    assert_string_equal(noted,
                        "contacts of 2 classes are treated as one class: mine (2), boulder (1)");
    assert_int_equal(contact_set_read(&report, file_in("l.csv"), &choice, &set),
                     SONJECT_ERROR_INPUT);
    contact_set_clear(&set);
    assert_non_null(strstr(
        report.message, "holds no contacts of the chosen classes, but of mine (2), boulder (1)"));
}

/* ---- Quantiles. */

WITH_LABELS(test_quantiles)
{
    struct contact_set set;
    put("q.yaml", "quantiles: [0.05, 0.5, 1]\ncontacts: 120\nhighlight_range: [40 cm, 0.4, 6 m]\n"
                  "shadow_along: [1, 2, 3 km]\n");
    EXPECT_OK(&report, read_set("q.yaml", LABELLED_BOTH, &set));
    const struct extent_quantiles *quantiles = &set.quantiles;
    assert_int_equal(set.count, 0);
    assert_int_equal(quantiles->count, 3);
    assert_true(quantiles->contacts == 120.0);
    assert_true(quantiles->levels[0] == 0.05 && quantiles->levels[1] == 0.5 &&
                quantiles->levels[2] == 1.0);
    assert_true(quantiles->extents_m[1][0] == 0.4 && quantiles->extents_m[1][1] == 0.4 &&
                quantiles->extents_m[1][2] == 6.0);
    assert_true(quantiles->extents_m[2][0] == 1.0 && quantiles->extents_m[2][1] == 2.0 &&
                quantiles->extents_m[2][2] == 3000.0);
    for (int i = 0; i < 3; i++)
        assert_true(isnan(quantiles->extents_m[0][i]) && isnan(quantiles->extents_m[3][i]));
    contact_set_clear(&set);
}

WITH_LABELS(test_quantiles_that_are_wrong)
{
#define Q "quantiles: [0.1, 0.5]\ncontacts: 12\n"
    static const struct wrong wrong[] = {
        {"quantiles: [0.1, 0.5]\nshadow_range: [1, 2]\n",
         "%/q.yml:1:1: contacts: missing; add it (how many they were read off)"},
        {"contacts: 12\nshadow_range: [1, 2]\n",
         "%/q.yml:1:1: quantiles: missing; add it (shares of all contacts)"},
        {Q, "%/q.yml:1:1: has no extents: add highlight_along, highlight_range, shadow_along or "
            "shadow_range"},
        {Q "shadow_range: 1 m\n",
         "%/q.yml:3:15: shadow_range: must be a list of 1 to 32 numbers that rise"},
        {Q "shadow_range: [1, 2, 3]\n",
         "%/q.yml:3:15: shadow_range: has 3 numbers, but there are 2 quantiles"},
        {Q "shadow_range: [2, 1]\n",
         "%/q.yml:3:19: shadow_range[1]: must be above the one before, 2, not 1"},
        {Q "shadow_range: [0, 1]\n",
         "%/q.yml:3:16: shadow_range[0]: must be from 1e-06 to 1e+06 m, not 0"},
        {Q "shadow_range: [1, 2 s]\n",
         "%/q.yml:3:19: shadow_range[1]: unit 's' is not one of m, km, cm, mm"},
        {Q "shadow_rang: [1, 2]\n",
         "%/q.yml:3:1: shadow_rang: unknown key; did you mean 'shadow_range'?"},
        {"quantiles: [0.1, 0.1]\ncontacts: 12\nshadow_range: [1, 2]\n",
         "%/q.yml:1:18: quantiles[1]: must be above the one before, 0.1, not 0.1"},
        {"quantiles: [5, 95]\ncontacts: 0\nshadow_range: [1, 2]\n",
         "%/q.yml:1:13: quantiles[0]: must be from 0 to 1, not 5\n"
         "%/q.yml:2:11: contacts: must be 1...1e+09, not 0"},
        {"names: [a\n", "%/q.yml:2:1: names: not valid YAML (while parsing a flow sequence: did "
                        "not find expected ',' or ']'); check indentation, colons, quotes and "
                        "brackets"},
    };
    expect_all_refused("q.yml", "q.yml", wrong, COUNT(wrong));
    char text[800] = Q "shadow_range: [";
    for (int i = 0; i < 33; i++)
        sprintf(text + strlen(text), "%d, ", i + 1);
    put("q.yml", strcat(text, "]\n"));
    expect_refused("q.yml",
                   "%/q.yml:3:15: shadow_range: must be a list of 1 to 32 numbers that rise");
}

TEST_PROGRAM(NULL, NULL)
