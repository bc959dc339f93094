#include "description/formulas.h"

#include <string.h>

/* ---- names ----------------------------------------------------------------------------------
 */

/* What a name was found to mean. */
typedef struct meaning {
    zt_term term;
    int width;
} meaning;

/* Meanings of names, by the order in which they were asked for. */
typedef struct lookup {
    zt_reading *reading;
    meaning *meanings;
    int32_t count, room;
    bool out_of_memory;
} lookup;

/* A variable that is a number. */
static bool find_number(double *number, const zt_names *variables, const char *name) {
    const zt_node *node = zt_name_find(variables, name);
    return node && node->kind == ZT_NODE_TEXT && !node->quoted &&
           zt_text_number(number, node->text, node->text + strlen(node->text));
}

static bool make_room(lookup *l) {
    if (l->count < l->room) return true;
    int32_t room = l->room ? 2 * l->room : 16;
    meaning *more = ZT_PUSH(l->reading->temporary, meaning, (size_t)room);
    l->out_of_memory = !more;
    if (!more) return false;
    if (l->count) memcpy(more, l->meanings, (size_t)l->count * sizeof *more);
    l->meanings = more;
    l->room = room;
    return true;
}

static int find(void *user, const char *name, int32_t *id) {
    lookup *l = user;
    meaning m = {.width = 1};
    if (zt_find_property(&m.term.reference, &l->reading->things, name))
        m.width = zt_formula_reference_width(m.term.reference.property->kind);
    else if (!find_number(&m.term.number, &l->reading->variables, name))
        return 0;
    if (!make_room(l)) return 0;
    *id = l->count;
    l->meanings[l->count++] = m;
    return m.width;
}

static void suggest(void *user, zt_nearest *nearest) {
    enum { TRIED_MAX = 1000 };
    zt_reading *reading = ((lookup *)user)->reading;
    const zt_node *variables = reading->variables.mapping;
    for (int32_t i = 0; variables && i < variables->count && i < TRIED_MAX; i++)
        zt_nearest_try(nearest, zt_node_key(variables, i)->text);
    zt_suggest_properties(reading, nearest);
}

/* ---- compiling ------------------------------------------------------------------------------
 */

/* Where the text after "=" stands, if the line of the description has it letter for letter. */
static void place_text(zt_formula *formula, const zt_node *node) {
    const char *text = node->text + 1, *line = node->place.source_line;
    int column = node->place.column + node->quoted + 1;
    formula->text = node->place;
    for (int i = 1; line && i < column && *line && *line != '\n'; i++) {
        line++;
        while (((unsigned char)*line & 0xC0) == 0x80) line++;
    }
    formula->text_is_plain = line && strncmp(line, text, strlen(text)) == 0;
    if (formula->text_is_plain) formula->text.column = column;
}

static zt_status open_formulas(zt_reading *reading) {
    zt_animation *animation = reading->animation;
    zt_formulas *formulas = &animation->formulas;
    const zt_film *film = &animation->film;
    if (formulas->expressions) return ZT_OK;
    formulas->door = zt_expression_door_open(reading->mistakes.listener);
    if (!formulas->door) return ZT_EUNSUPPORTED;
    return formulas->door->open(&formulas->expressions, film->rate,
                                zt_rate_time(film->rate, film->frame_count));
}

static zt_status keep_terms(zt_formula *formula, const lookup *l) {
    zt_animation *animation = l->reading->animation;
    int count;
    const zt_expression_reference *references =
        animation->formulas.door->references(formula->expression, &count);
    zt_term *terms = ZT_PUSH(&animation->arena, zt_term, (size_t)count);
    if (!terms) return ZT_EMEMORY;
    for (int i = 0; i < count; i++) terms[i] = l->meanings[references[i].id].term;
    formula->terms = terms;
    formula->term_count = count;
    return ZT_OK;
}

zt_status zt_formula_read(zt_formula *formula, zt_reading *reading, const zt_node *node,
                          const zt_property *property) {
    *formula = (zt_formula){0};
    place_text(formula, node);
    ZT_TRY(open_formulas(reading));
    const zt_formulas *formulas = &reading->animation->formulas;
    lookup l = {.reading = reading};
    const zt_expression_names names = {find, suggest, &l};
    zt_expression_mistake mistake;
    zt_status status =
        formulas->door->compile(&formula->expression, formulas->expressions, node->text + 1,
                                zt_formula_result_width(property->kind),
                                zt_formula_spreads(property->kind), &names, &mistake);
    if (l.out_of_memory) return ZT_EMEMORY;
    if (status == ZT_OK) return keep_terms(formula, &l);
    if (status != ZT_EDESCRIPTION) return status;
    zt_place place = zt_formula_place(formula, &mistake);
    zt_mistake(&reading->mistakes, &place, "%s", mistake.text);
    return ZT_OK;
}
