// Evaluate a golden function in Java: java Function.java FOLDER 17.25 3600
// Prints t, x, y, z, vx, vy, vz for each time; docs/format.md specifies the files and every operation.
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.DoubleBuffer;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.Arrays;
import java.util.regex.Matcher;
import java.util.regex.Pattern;

public class Function {
    static String value(String json, String key) {
        Matcher found = Pattern.compile("\"" + key + "\": (\\[[^\\]]*\\]|[^,\\n]*)").matcher(json);
        if (!found.find()) throw new IllegalArgumentException("function.json has no " + key);
        return found.group(1);
    }

    static double[] quoted(String text) {
        return Pattern.compile("0x[^\"]+").matcher(text).results().mapToDouble(m -> Double.parseDouble(m.group())).toArray();
    }

    public static void main(String[] words) throws Exception {
        String json = Files.readString(Path.of(words[0], "function.json"));
        byte[] bytes = Files.readAllBytes(Path.of(words[0], "function.f64"));
        DoubleBuffer c = ByteBuffer.wrap(bytes).order(ByteOrder.LITTLE_ENDIAN).asDoubleBuffer();
        int degree = Integer.parseInt(value(json, "degree"));
        double[] times = quoted(value(json, "times")), square = quoted(value(json, "length_squared"));
        int series = square.length == 1 ? 2 : 3, last = times.length - 1;
        StringBuilder out = new StringBuilder();
        for (String word : Arrays.copyOfRange(words, 1, words.length)) {
            double t = Double.parseDouble(word);
            if (!(t >= 0 && t <= times[last])) throw new IllegalArgumentException(t + ": not within 0 to " + times[last] + " s");
            int found = Arrays.binarySearch(times, t), piece = Math.min(found < 0 ? -found - 2 : found, last - 1);
            double a = times[piece], b = times[piece + 1], w = b - a, u = ((t - a) - (b - t)) / w, y = u + u;
            double[] state = new double[6];
            for (int i = 0; i < series; i++) {
                int k = (piece * series + i) * (degree + 1);
                double b1 = 0, b2 = 0, d1 = 0, d2 = 0;
                for (int j = degree; j > 0; j--) {
                    double b0 = (y * b1 - b2) + c.get(k + j), d0 = (y * d1 - d2) + j * c.get(k + j);
                    b2 = b1;
                    b1 = b0;
                    d2 = d1;
                    d1 = d0;
                }
                state[i] = (u * b1 - b2) + c.get(k);
                state[i + 3] = (d1 + d1) / w;
            }
            if (series == 2) {
                state[2] = -Math.sqrt(square[0] - (state[0] * state[0] + state[1] * state[1]));
                state[5] = -(state[0] * state[3] + state[1] * state[4]) / state[2];
            }
            out.append(t);
            for (double number : state) out.append(' ').append(number);
            out.append('\n');
        }
        System.out.print(out);
    }
}
