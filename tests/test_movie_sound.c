/* The sound of movies: in each container, as long as the film, and on the beat. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "cards.h"

/* A tone: 16 bits, two channels, of `seconds`; the right one is silent. */
static void write_wave(const char *path, double seconds, int rate) {
    uint32_t count = (uint32_t)(seconds * rate), bytes = count * 4;
    struct {
        char riff[4];
        uint32_t size;
        char wave[8];
        uint32_t head;
        uint16_t kind, channels;
        uint32_t rate, byte_rate;
        uint16_t block, bits;
        char data[4];
        uint32_t bytes;
    } head = {"RIFF",
              36 + bytes,
              {'W', 'A', 'V', 'E', 'f', 'm', 't', ' '},
              16,
              1,
              2,
              (uint32_t)rate,
              (uint32_t)rate * 4,
              4,
              16,
              {'d', 'a', 't', 'a'},
              bytes};
    memcpy(head.riff, "RIFF", 4);
    FILE *file = fopen(path, "wb");
    assert_int_equal(fwrite(&head, 44, 1, file), 1);
    for (uint32_t i = 0; i < count; i++) {
        int16_t sample[2] = {(int16_t)(20000 * sin(2 * 3.14159265358979 * 440 * i / rate)), 0};
        fwrite(sample, 4, 1, file);
    }
    fclose(file);
}

/* What is heard of a film: how many samples, when they begin, and how often the left channel
 * crosses zero upwards. */
static void listen_to(const char *path, enum AVCodecID *id, double *seconds, int *crossings) {
    AVFormatContext *container = NULL;
    assert_int_equal(avformat_open_input(&container, path, NULL, NULL), 0);
    assert_true(avformat_find_stream_info(container, NULL) >= 0);
    assert_int_equal(container->nb_streams, 2);
    AVStream *stream = container->streams[1];
    *id = stream->codecpar->codec_id;
    const AVCodec *codec = avcodec_find_decoder(*id);
    AVCodecContext *decoder = avcodec_alloc_context3(codec);
    avcodec_parameters_to_context(decoder, stream->codecpar);
    decoder->pkt_timebase = stream->time_base;
    assert_int_equal(avcodec_open2(decoder, codec, NULL), 0);
    AVPacket *packet = av_packet_alloc();
    AVFrame *frame = av_frame_alloc();
    int64_t count = 0;
    double last = 0;
    *crossings = 0;
    for (bool more = true; more;) {
        more = av_read_frame(container, packet) >= 0;
        if (more && packet->stream_index != 1) {
            av_packet_unref(packet);
            continue;
        }
        avcodec_send_packet(decoder, more ? packet : NULL);
        av_packet_unref(packet);
        while (avcodec_receive_frame(decoder, frame) >= 0) {
            if (count == 0) /* at the beginning, but for what is cut away */
                assert_true(fabs((double)frame->pts * av_q2d(stream->time_base)) < 0.03);
            bool planar = av_sample_fmt_is_planar(frame->format);
            int channels = planar ? 1 : frame->ch_layout.nb_channels;
            for (int i = 0; i < frame->nb_samples; i++, count++) {
                double now = frame->format == AV_SAMPLE_FMT_S16
                                 ? ((int16_t *)(void *)frame->data[0])[i * channels] / 32768.0
                                 : (double)((float *)(void *)frame->data[0])[i * channels];
                if (fabs(now) < 0.05) continue;
                *crossings += last < 0 && now > 0;
                last = now;
            }
        }
    }
    *seconds = (double)count / decoder->sample_rate;
    av_frame_free(&frame);
    av_packet_free(&packet);
    avcodec_free_context(&decoder);
    avformat_close_input(&container);
}

/* Sound is the film's: copied where the container takes it, else encoded; cut where the film
 * ends, and over where it is over before; on the beat. */
static void sound(void **state) {
    (void)state;
    write_wave("tone.wav", 3, 44100);
    write_wave("short.wav", 0.25, 48000);
    const struct {
        const char *path, *sound;
        enum AVCodecID id;
        double seconds;
    } cases[] = {
        {"sound.mp4", "tone.wav", AV_CODEC_ID_AAC, 1},
        {"sound.mov", "tone.wav", AV_CODEC_ID_PCM_S16LE, 1},
        {"sound.mkv", "tone.wav", AV_CODEC_ID_PCM_S16LE, 1},
        {"sound.webm", "tone.wav", AV_CODEC_ID_OPUS, 1},
        {"short.mp4", "short.wav", AV_CODEC_ID_AAC, 0.25},
        {"short.mkv", "short.wav", AV_CODEC_ID_PCM_S16LE, 0.25},
        {"again.mp4", "sound.mp4", AV_CODEC_ID_AAC, 1},
        {"again.webm", "sound.webm", AV_CODEC_ID_OPUS, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const zt_output_option options[] = {{"audio", cases[i].sound}, {NULL, NULL}};
        write_movie_by(cases[i].path, &format, options, 24);
        enum AVCodecID id;
        double seconds;
        int crossings;
        listen_to(cases[i].path, &id, &seconds, &crossings);
        assert_int_equal(id, cases[i].id);
        /* To the sample where it is one by one; else to a packet. */
        double packet = id == AV_CODEC_ID_PCM_S16LE ? 0.0001 : 0.05;
        if (fabs(seconds - cases[i].seconds) > packet)
            fail_msg("%s: %g s of sound", cases[i].path, seconds);
        if (fabs(crossings - 440 * cases[i].seconds) > 22)
            fail_msg("%s: %d periods", cases[i].path, crossings);
        film m = film_open(cases[i].path);
        assert_int_equal(m.packet_count, 24);
        assert_int_equal(m.stream->start_time, 0);
        film_close(&m);
    }
    /* Stills and GIFs have none, which is no mistake. */
    const zt_output_option options[] = {{"audio", "tone.wav"}, {NULL, NULL}};
    write_movie_by("silent.gif", &format, options, 2);
    write_movie_by("silent.####.png", &format, options, 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sound),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
